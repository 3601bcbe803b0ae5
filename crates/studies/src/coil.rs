//! Study `coil`: test time against error of the coil resistance, for several settling times of the current and several
//! numbers of averaged scans; then the errors from self-heating, from temperature and from the converter.
//!
//! The converter runs freely, and only a conversion that begins after the settling time counts. Two channels share the
//! converter: the first scan takes three conversion periods, each further scan two. Averaging many scans biases the
//! mean, because the coil heats up under the pre-bias voltage meanwhile.

use super::figure::{Bar, Figure};
use super::method::{self, BAUDS, TimedParameter};
use super::order::Order;
use super::output::Report;
use super::variant::{Change, Variant};
use machine::dut::em_relay::Parameter;

const COIL: TimedParameter = TimedParameter::of(Parameter::CoilResistance, &["coil"]);
/// Methods to compare: settling time in ms, and number of scans. The third pair is the default of a recipe.
const METHODS: [(i64, i64); 7] = [
    (1, 1),
    (4, 1),
    (13, 1),
    (25, 1),
    (13, 4),
    (13, 16),
    (13, 64),
];
/// Greatest rms error of the default method in the world with all errors, percent.
const TOTAL_PCT: f64 = 0.12;

/// Returns worlds for the default method, each with one kind of error.
fn worlds() -> [(&'static str, Vec<Change>); 3] {
    [
        (
            "with converter errors",
            vec![
                ("devices.ai_gain_pct", 0.1.into()),
                ("devices.ai_offset_pct_of_range", 0.05.into()),
            ],
        ),
        (
            "with part 0.15 K off the track",
            vec![("environment.part_minus_track_sd_k", 0.15.into())],
        ),
        (
            "with thermometers 0.1 K off",
            vec![("environment.rtd_error_sd_k", 0.1.into())],
        ),
    ]
}

/// Runs the lots and makes the report.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let mut methods = Vec::new();
    for baud in BAUDS {
        for (settles_ms, scans) in METHODS {
            let recipe = vec![
                ("test.strategy.coil.settles_ms", settles_ms.into()),
                ("test.strategy.coil.scans", scans.into()),
            ];
            let lots = method::lots(&Variant::exact(baud, recipe), order)?;
            let name = format!("settle {settles_ms} ms, scans {scans}, {baud}");
            methods.push(COIL.row(name, &lots));
        }
    }
    let groups = vec![methods, errors(order)?];
    Ok(method::report("coil", order, groups, 2, vec![TOTAL_PCT]))
}

/// Runs the default method in worlds with one error each, and in the world with all of them.
fn errors(order: &Order) -> anyhow::Result<Vec<Figure>> {
    let mut rows = Vec::new();
    for (name, world) in worlds() {
        let variant = Variant::exact(BAUDS[0], Vec::new()).in_world(world);
        rows.push(COIL.row(name, &method::lots(&variant, order)?));
    }
    let all = Variant::erring(BAUDS[0], Vec::new());
    let total = COIL.row("with every error of the world", &method::lots(&all, order)?);
    rows.push(total.bar(Bar::AtMost(TOTAL_PCT)));
    Ok(rows)
}
