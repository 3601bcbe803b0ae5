//! Defects of a temperature relay.

use super::part::{Chatter, Intermittent, Stuck, Values};
use super::table::DefectTable;
use crate::world::draw::Draw;
use crate::world::signal::vocabulary;

vocabulary! {
    /// A defect of the simulated lot, with its name in the truth file.
    Defect {
        /// Operates outside the limits.
        Operate = "operate_out",
        /// Resets outside the limits.
        Reset = "reset_out",
        /// Operates inside the limits, with too small or too large a differential.
        Differential = "differential_out",
        /// The contact never opens.
        StuckClosed = "stuck_closed",
        /// The contact never closes.
        StuckOpen = "stuck_open",
        /// Operates once, then stays operated until a person presses its reset button.
        NeverResets = "never_resets",
        /// A part for another temperature.
        WrongTemperature = "wrong_temperature",
        /// The contact makes on rise where it should break.
        WrongContact = "wrong_contact",
        /// Breaks slowly, without snap and differential.
        Creep = "creep",
        /// Opens and closes many times near the operate temperature.
        Chatter = "chatter",
        /// The closed contact opens for milliseconds from time to time.
        Intermittent = "intermittent",
        /// The closed contact has too much resistance.
        HighResistance = "high_resistance",
        /// Switches at another temperature every time.
        Scatter = "large_scatter",
        /// Follows its surroundings too slowly.
        Slow = "slow",
    }
}

/// Limits of operate temperature, reset temperature and differential, from the recipe of the lot.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Lowest and highest operate temperature, degrees Celsius.
    pub operate_c: [f64; 2],
    /// Lowest and highest reset temperature, degrees Celsius.
    pub reset_c: [f64; 2],
    /// Least and greatest differential, kelvin.
    pub differential_k: [f64; 2],
}

/// Differential of a creeping contact, kelvin.
const CREEPING_K: f64 = 0.3;

impl Defect {
    /// Changes the true values of a part to those of its defect.
    pub(super) fn damage(
        self,
        values: &mut Values,
        limits: &Limits,
        table: &DefectTable,
        draw: &mut Draw,
    ) {
        let outside = |ends: [f64; 2], draw: &mut Draw| {
            let by_k = draw.between(table.outside_k);
            match draw.uniform() < 0.5 {
                true => ends[0] - by_k,
                false => ends[1] + by_k,
            }
        };
        match self {
            Self::Operate => {
                let differential_k = values.differential_k();
                values.operate_c = outside(limits.operate_c, draw);
                values.reset_c = values.operate_c - differential_k;
            }
            Self::Reset => {
                // Above its limit, the reset temperature may come too near to the operate temperature; below it there
                // is always room.
                let by_k = draw.between(table.outside_k);
                let high = limits.reset_c[1] + by_k;
                let room = high < values.operate_c - 1.0 && draw.uniform() < 0.5;
                values.reset_c = if room { high } else { limits.reset_c[0] - by_k };
            }
            Self::Differential => {
                let by_k = draw.between(table.outside_k);
                let narrow_k = limits.differential_k[0] - by_k;
                let narrow = narrow_k > 1.0 && draw.uniform() < 0.5;
                let wide_k = limits.differential_k[1] + by_k;
                values.reset_c = values.operate_c - if narrow { narrow_k } else { wide_k };
            }
            Self::StuckClosed => values.stuck = Some(Stuck::Closed),
            Self::StuckOpen => values.stuck = Some(Stuck::Open),
            Self::NeverResets => values.stuck = Some(Stuck::Operated),
            Self::WrongTemperature => {
                let sign = if draw.uniform() < 0.5 { -1.0 } else { 1.0 };
                values.operate_c += sign * table.wrong_type_k;
                values.reset_c += sign * table.wrong_type_k;
            }
            Self::WrongContact => values.breaks = !values.breaks,
            Self::Creep => {
                values.creep_k = draw.between(table.creep_k);
                values.reset_c = values.operate_c - CREEPING_K;
            }
            Self::Chatter => {
                values.chatter = Some(Chatter {
                    band_k: draw.between(table.chatter_k),
                    per_s: 2.0 * draw.between(table.chatter_hz),
                });
            }
            Self::Intermittent => {
                values.intermittent = Some(Intermittent {
                    share: draw.between(table.intermittent_pct) / 100.0,
                    open_ms: table.intermittent_ms,
                });
            }
            Self::HighResistance => values.contact_mohm = draw.between(table.high_ohm) * 1e3,
            Self::Scatter => values.scatter_k = table.scatter_k,
            Self::Slow => values.lag_s = values.lag_s.map(|it| it * table.slow_factor),
        }
    }
}
