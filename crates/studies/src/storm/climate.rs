//! Faults that the storms over a kind of part draw from: those of its world, its output circuit and its instruments.

use crate::dice::Dice;
use machine::dut::Kind;
use machine::rig::wiring::Wiring;

/// What a storm over a kind of part draws from.
#[derive(Debug, Clone, Copy)]
pub struct Climate {
    /// Tables of the world that differ from the default: more defects, so that parts go to every bin.
    defects: &'static str,
    /// True when the rig is calibrated before its lots.
    pub calibrates: bool,
    /// Faults of the output circuit, which begin at an instant and last `fault_hold_ms`.
    circuit: &'static [&'static str],
    /// Faults of SCPI instruments and their links.
    of_an_instrument: &'static [&'static str],
}

/// Storms over electromagnetic relays.
const RELAYS: Climate = Climate {
    defects: "[defects]\nrate_pct = 25.0\n",
    calibrates: true,
    circuit: &[],
    of_an_instrument: &[],
};

/// Storms over solid-state relays.
const SOLID_STATE: Climate = Climate {
    defects: "[ssr.defects]\nrate_pct = 25.0\n\n[ssr_ac.defects]\nrate_pct = 25.0\n",
    calibrates: false,
    circuit: &[
        "line_contactor_welded",
        "line_contactor_broken",
        "loop_contactor_welded",
        "loop_contactor_broken",
        "mirrors_stuck",
        "line_dead",
        "loop_dead",
        "output_lead_open",
        "socket_short",
    ],
    of_an_instrument: &[
        "reply_lost",
        "reply_late",
        "reply_twice",
        "reply_joined",
        "reply_split",
        "reply_crlf",
        "block_cut",
        "block_empty",
        "block_huge",
        "block_newline",
        "closed_before",
        "closed_inside",
        "half_kept",
        "port_busy",
        "send_paused",
        "errors_overflow",
        "local",
        "power_cycle",
        "over_range",
        "not_a_number",
        "wrong_identity",
        "address_changed",
    ],
};

impl Climate {
    /// Returns the climate of storms over a kind of part.
    pub const fn of(kind: Kind) -> Self {
        match kind {
            Kind::Ssr => SOLID_STATE,
            Kind::EmRelay | Kind::Resistor | Kind::Thermostat => RELAYS,
        }
    }

    /// Returns the text of the world in which a fault that begins at an instant lasts `hold_us` microseconds.
    pub fn world(&self, hold_us: u64) -> String {
        let hold_ms = hold_us as f64 * 1e-3;
        format!(
            "{}\n[mechanism]\nfault_hold_ms = {hold_ms:.3}\n",
            self.defects
        )
    }

    /// Returns true when the rig has instruments or contactors of its own.
    pub const fn is_of_circuits(&self) -> bool {
        !self.circuit.is_empty()
    }

    /// Draws a fault of the output circuit.
    pub fn circuit_fault(&self, dice: &mut Dice) -> &'static str {
        dice.one::<&str>(self.circuit)
    }

    /// Draws a fault of an instrument, or of all, within a window of rig time (`FROM..UNTIL` in seconds).
    pub fn instrument_fault(&self, dice: &mut Dice, wiring: &Wiring, window: &str) -> String {
        let fault = *dice.one(self.of_an_instrument);
        let target = match dice.once_in(3) {
            true => String::new(),
            false => format!("{}:", dice.one(&wiring.instruments).name),
        };
        let chance = *dice.one(&["0.001", "0.01", "0.1", "1"]);
        let lasts = match fault {
            "reply_late" => format!("/{}", dice.between(10, 4_000)),
            "send_paused" => format!("/{}", dice.between(50, 3_000)),
            _lasts_no_time => String::new(),
        };
        format!("{fault}={target}{chance}{lasts}@{window}")
    }
}
