//! Study `contact`: test time against error of the contact resistance, for polarities of the measuring current, a
//! drifting thermal EMF, numbers of closures, and early stop (no further closures once the verdict is certain).
//!
//! - Error is the difference from the true resistance of the closures that the rig read. Every world here has a thermal
//!   EMF of 10 uV (1 sd).
//! - Repeatability is the scatter over repeated tests of the same bodies. Films on the contact cause nearly all of this
//!   scatter, which falls with the square root of the number of closures.
//! - Seconds are the rig time of all stages that read a contact; the same stages also measure times and bounce.

use super::figure::{Figure, rms};
use super::lot::Lot;
use super::method::{self, BAUDS, TimedParameter};
use super::order::Order;
use super::output::Report;
use super::variant::{Change, Variant};
use machine::dut::em_relay::Parameter;
use quality::Spread;

const STAGES: &[&str] = &["nc_contact", "timed_operate", "timed_release"];
const CONTACTS: [(&str, TimedParameter); 2] = [
    (
        "NO",
        TimedParameter::of(Parameter::ContactResistanceNo, STAGES),
    ),
    (
        "NC",
        TimedParameter::of(Parameter::ContactResistanceNc, STAGES),
    ),
];
/// Thermal EMF of a part, microvolts (1 sd).
const EMF: Change = ("lot.thermal_emf_sd_uv", toml::Value::Float(10.0));
/// Drift of the EMF, microvolts per second: so fast that the drift adds more error than noise does to a method with
/// two polarities.
const DRIFT: Change = ("board.emf_drift_uv_per_s", toml::Value::Float(5000.0));
/// Number of passes of each body in the comparison of films.
const PASSES: u64 = 6;

/// Sequences of polarities: name in the recipe, and name in the report.
const POLARITIES: [(&str, &str); 2] = [("plus_minus", "+ -"), ("plus_minus_minus_plus", "+ - - +")];

fn recipe(polarities: &str, closures: i64, stops_early: bool) -> Vec<Change> {
    vec![
        ("test.strategy.contact.polarities", polarities.into()),
        ("test.strategy.contact.closures", closures.into()),
        ("test.strategy.contact.stops_early", stops_early.into()),
    ]
}

/// Runs the lots and makes the report.
///
/// # Errors
/// Fails when a lot cannot be run.
pub fn study(order: &Order) -> anyhow::Result<Report> {
    let groups = vec![
        polarities(order)?,
        drifting(order)?,
        films(order)?,
        early(order)?,
    ];
    Ok(method::report("contact", order, groups, 2, vec![0.3]))
}

fn rows(name: &str, lots: &[Lot]) -> [Figure; 2] {
    CONTACTS.map(|(contact, timed)| timed.row(format!("{contact} {name}"), lots))
}

fn polarities(order: &Order) -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for baud in BAUDS {
        for (key, sign) in POLARITIES {
            for closures in [1, 3] {
                let variant =
                    Variant::exact(baud, recipe(key, closures, false)).in_world(vec![EMF]);
                let name = format!("{sign}, closures {closures}, {baud}");
                figures.extend(rows(&name, &method::lots(&variant, order)?));
            }
        }
    }
    Ok(figures)
}

fn drifting(order: &Order) -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (key, sign) in POLARITIES {
        let variant = Variant::exact(BAUDS[0], recipe(key, 1, false)).in_world(vec![EMF, DRIFT]);
        let name = format!("{sign}, EMF drifts 5 mV/s");
        figures.extend(rows(&name, &method::lots(&variant, order)?));
    }
    Ok(figures)
}

/// Shows the effect of contact films: for each number of closures, the scatter of one body from test to test, percent
/// of its resistance.
fn films(order: &Order) -> anyhow::Result<Vec<Figure>> {
    let bodies = (order.parts / PASSES).max(2);
    let order = Order {
        parts: bodies * PASSES,
        ..order.clone()
    };
    let mut figures: Vec<Figure> = Vec::new();
    for closures in [1, 2, 4, 8] {
        let variant = Variant {
            faults: vec![format!("refeed={bodies}")],
            ..Variant::exact(BAUDS[0], recipe("plus_minus", closures, false)).in_world(vec![EMF])
        };
        let lots = method::lots(&variant, &order)?;
        for (contact, timed) in CONTACTS {
            let name = format!("{contact} of the same body, closures {closures}");
            figures.push(repeatability(name, &lots, timed, bodies));
        }
    }
    Ok(by_root(figures))
}

/// Adds the column `by_root` to each row: the scatter expected from the first row of the same contact if it falls with
/// the square root of the number of closures. The NC contact has one closure more than NO: it is closed also at rest.
fn by_root(figures: Vec<Figure>) -> Vec<Figure> {
    let first: Vec<Option<f64>> = figures.iter().take(2).map(|row| row.value).collect();
    let root = |place: usize| {
        let (contact, closures) = (place % 2, 2f64.powi((place / 2) as i32));
        let at_rest = contact as f64;
        first[contact].map(|value| value * ((1.0 + at_rest) / (closures + at_rest)).sqrt())
    };
    let rows = figures.into_iter().enumerate();
    rows.map(|(place, row)| row.with("by_root", root(place)))
        .collect()
}

/// Returns the repeatability: the rms over bodies of the standard deviation of the values of one body, percent of its
/// mean.
fn repeatability(name: String, lots: &[Lot], timed: TimedParameter, bodies: u64) -> Figure {
    let body = |lot: &Lot, body: u64| -> Vec<f64> {
        let again = lot.good().filter(|part| (part.seq - 1) % bodies == body);
        let readings = again.filter_map(|part| part.reading(timed.parameter));
        readings.map(|reading| reading.value).collect()
    };
    let relative: Vec<f64> = lots
        .iter()
        .flat_map(|lot| (0..bodies).map(move |it| body(lot, it)))
        .filter_map(|values| {
            let spread = Spread::of(&values);
            Some(100.0 * spread.sd()? / spread.mean()?)
        })
        .collect();
    let (n, rms) = (relative.len() as u64, rms(relative.into_iter()));
    Figure::new(name, n, rms, "%").with("seconds", timed.seconds(lots).mean())
}

/// Compares early stop with a fixed number of closures: early stop reads a part far from its limit once, and a part
/// near the limit up to eight times.
fn early(order: &Order) -> anyhow::Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for mohm in [20.0, 60.0, 80.0, 95.0] {
        for stops_early in [true, false] {
            let world = vec![
                EMF,
                ("lot.contact_no_mohm_median", mohm.into()),
                ("lot.contact_ln_sd", 0.01.into()),
            ];
            let variant =
                Variant::exact(BAUDS[0], recipe("plus_minus", 8, stops_early)).in_world(world);
            let lots = method::lots(&variant, order)?;
            let way = if stops_early { "up to 8" } else { "8" };
            let name = format!("NO of {mohm} mOhm, closures {way}");
            figures.push(CONTACTS[0].1.row(name, &lots));
        }
    }
    Ok(figures)
}
