//! Temperatures around the rig and the sensors that read them.

use super::draw::Draw;
use super::signal::Sensor;
use super::table::EnvironmentTable;

/// True temperatures and the errors of their sensors, degrees Celsius.
#[derive(Debug, Clone)]
pub struct Environment {
    /// Air temperature around nest and magazine.
    pub ambient_c: f64,
    /// Temperature of the magazine track, and mean temperature of the parts in it.
    pub track_c: f64,
    read_c: [f64; 3],
}

impl Environment {
    /// Draws the temperatures and the errors of the sensors.
    pub fn new(table: &EnvironmentTable, draw: &mut Draw) -> Self {
        let ambient_c = draw.between([table.ambient_low_c, table.ambient_high_c]);
        let track_c = ambient_c + draw.half(table.track_minus_ambient_half_k);
        let nest_c = ambient_c + draw.half(table.nest_minus_ambient_half_k);
        let read_c = [nest_c, ambient_c, track_c].map(|t| draw.normal(t, table.rtd_error_sd_k));
        Self {
            ambient_c,
            track_c,
            read_c,
        }
    }

    /// Returns the reading of a sensor, degrees Celsius.
    pub fn sensor_c(&self, sensor: Sensor) -> f64 {
        self.read_c[sensor as usize]
    }
}
