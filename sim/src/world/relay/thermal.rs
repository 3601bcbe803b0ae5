//! Coil heating: winding and body as two heat capacities, in closed form for constant power.

use super::table::RelayTable;

/// Two heat capacities; temperatures in kelvin above the ambient.
#[derive(Debug, Clone)]
pub struct Thermal {
    coil: f64,
    body: f64,
    rate: [[f64; 2]; 2],
    poles: [f64; 2],
    rise_k_per_w: [f64; 2],
}

impl Thermal {
    /// Creates both heat capacities `above_k` kelvin above the ambient.
    pub fn new(table: &RelayTable, above_k: f64) -> Self {
        let (to_body, to_air) = (
            1.0 / table.coil_to_body_k_per_w,
            1.0 / table.body_to_air_k_per_w,
        );
        let (cu, body) = (table.coil_heat_j_per_k, table.body_heat_j_per_k);
        let rate = [
            [-to_body / cu, to_body / cu],
            [to_body / body, -(to_body + to_air) / body],
        ];
        let (trace, det) = (
            rate[0][0] + rate[1][1],
            rate[0][0] * rate[1][1] - rate[0][1] * rate[1][0],
        );
        let root = (trace * trace / 4.0 - det).sqrt();
        let air = table.body_to_air_k_per_w;
        Self {
            coil: above_k,
            body: above_k,
            rate,
            poles: [trace / 2.0 + root, trace / 2.0 - root],
            rise_k_per_w: [air + table.coil_to_body_k_per_w, air],
        }
    }

    /// Returns the temperature of the winding above the ambient, kelvin.
    pub fn coil_k(&self) -> f64 {
        self.coil
    }

    /// Advances by `dt_s` seconds at constant power.
    pub fn advance(&mut self, dt_s: f64, watts: f64) {
        let still = self.rise_k_per_w.map(|r| r * watts);
        let (x, y) = (self.coil - still[0], self.body - still[1]);
        let [p, q] = self.poles;
        let (ep, eq) = ((p * dt_s).exp(), (q * dt_s).exp());
        let moved = |row: [f64; 2], own: f64| {
            let drift = row[0] * x + row[1] * y;
            (ep * (drift - q * own) - eq * (drift - p * own)) / (p - q)
        };
        let (coil, body) = (moved(self.rate[0], x), moved(self.rate[1], y));
        self.coil = still[0] + coil;
        self.body = still[1] + body;
    }
}
