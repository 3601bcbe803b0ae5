//! Heat capacities, conductances and power of a chamber: three designs, and how chambers of a design differ.

use crate::world::draw::Draw;

/// Lumped values of a chamber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChamberValues {
    /// Heat capacities of heater, air (or oil, or block), wall, rack and insulation, J/K.
    pub capacity_j_per_k: [f64; 5],
    /// Conductance from heater to air at full fan, W/K.
    pub heater_air_w_per_k: f64,
    /// Conductance from air to wall at full fan, W/K.
    pub air_wall_w_per_k: f64,
    /// Conductance from air to rack at full fan, W/K.
    pub air_rack_w_per_k: f64,
    /// Conductance from wall to insulation, W/K.
    pub wall_insulation_w_per_k: f64,
    /// Conductance from insulation to ambient, W/K.
    pub insulation_ambient_w_per_k: f64,
    /// Conductance from air to ambient with everything shut, W/K.
    pub leak_w_per_k: f64,
    /// Additional conductance from air to ambient through the open vent, W/K.
    pub vent_w_per_k: f64,
    /// Additional conductance from air to ambient through the open door, W/K.
    pub door_w_per_k: f64,
    /// Power of the heater at nominal mains, W.
    pub heater_w: f64,
    /// Power that the fan leaves in the air at full speed, W.
    pub fan_w: f64,
    /// Temperature around the chamber, degrees Celsius.
    pub ambient_c: f64,
}

/// Differences between chambers of a design: standard deviations in percent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Of each heat capacity.
    pub capacity_pct: f64,
    /// Of each conductance.
    pub conductance_pct: f64,
    /// Of the power of heater and fan, which depends on mains and heating elements.
    pub power_pct: f64,
}

impl Spread {
    /// Spread of the reference world.
    pub const USUAL: Self = Self {
        capacity_pct: 15.0,
        conductance_pct: 20.0,
        power_pct: 10.0,
    };
}

impl ChamberValues {
    /// A chamber with moving air for up to 40 sockets.
    pub const AIR: Self = Self {
        capacity_j_per_k: [450.0, 150.0, 4000.0, 2900.0, 3000.0],
        heater_air_w_per_k: 50.0,
        air_wall_w_per_k: 35.0,
        air_rack_w_per_k: 25.0,
        wall_insulation_w_per_k: 4.0,
        insulation_ambient_w_per_k: 4.0,
        leak_w_per_k: 0.5,
        vent_w_per_k: 18.0,
        door_w_per_k: 40.0,
        heater_w: 2200.0,
        fan_w: 60.0,
        ambient_c: 23.0,
    };

    /// A stirred oil bath; its vent is a cooling coil, its fan the stirrer.
    pub const OIL: Self = Self {
        capacity_j_per_k: [400.0, 15_000.0, 3000.0, 600.0, 2500.0],
        heater_air_w_per_k: 120.0,
        air_wall_w_per_k: 150.0,
        air_rack_w_per_k: 120.0,
        leak_w_per_k: 1.5,
        vent_w_per_k: 35.0,
        door_w_per_k: 3.0,
        heater_w: 3000.0,
        fan_w: 40.0,
        ..Self::AIR
    };

    /// A metal block with bores; its vent is a fan that cools it.
    pub const BLOCK: Self = Self {
        capacity_j_per_k: [60.0, 3800.0, 150.0, 200.0, 400.0],
        heater_air_w_per_k: 60.0,
        air_wall_w_per_k: 1.5,
        air_rack_w_per_k: 6.0,
        wall_insulation_w_per_k: 0.8,
        insulation_ambient_w_per_k: 0.8,
        leak_w_per_k: 0.3,
        vent_w_per_k: 3.5,
        door_w_per_k: 1.0,
        heater_w: 900.0,
        fan_w: 0.0,
        ..Self::AIR
    };

    /// Returns a chamber that is larger by a factor: capacities, conductances and powers.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        self.changed(|_| factor)
    }

    /// Draws one chamber of this design at random; each value stays within three standard deviations.
    #[must_use]
    pub fn drawn(self, spread: &Spread, draw: &mut Draw) -> Self {
        self.changed(|quantity| {
            let pct = match quantity {
                Quantity::Capacity => spread.capacity_pct,
                Quantity::Conductance => spread.conductance_pct,
                Quantity::Power => spread.power_pct,
            };
            // Keeps at least a tenth of the value, for worlds with a spread beyond 30 %.
            (1.0 + pct / 100.0 * draw.normal(0.0, 1.0).clamp(-3.0, 3.0)).max(0.1)
        })
    }

    /// Multiplies each value by its own factor, in the order of the fields.
    fn changed(self, mut factor: impl FnMut(Quantity) -> f64) -> Self {
        let mut by = |quantity, value: f64| value * factor(quantity);
        Self {
            capacity_j_per_k: self.capacity_j_per_k.map(|it| by(Quantity::Capacity, it)),
            heater_air_w_per_k: by(Quantity::Conductance, self.heater_air_w_per_k),
            air_wall_w_per_k: by(Quantity::Conductance, self.air_wall_w_per_k),
            air_rack_w_per_k: by(Quantity::Conductance, self.air_rack_w_per_k),
            wall_insulation_w_per_k: by(Quantity::Conductance, self.wall_insulation_w_per_k),
            insulation_ambient_w_per_k: by(Quantity::Conductance, self.insulation_ambient_w_per_k),
            leak_w_per_k: by(Quantity::Conductance, self.leak_w_per_k),
            vent_w_per_k: by(Quantity::Conductance, self.vent_w_per_k),
            door_w_per_k: by(Quantity::Conductance, self.door_w_per_k),
            heater_w: by(Quantity::Power, self.heater_w),
            fan_w: by(Quantity::Power, self.fan_w),
            ambient_c: self.ambient_c,
        }
    }
}

/// Quantity of a value; it decides which spread applies.
#[derive(Clone, Copy)]
enum Quantity {
    Capacity,
    Conductance,
    Power,
}
