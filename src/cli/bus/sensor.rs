//! `relayrig bus sensor`: what a temperature sensor shows at its terminals, to check a module with a resistance decade or a
//! voltage source.

use crate::cli::output::Output;
use anyhow::Context;
use app::exit::Exit;
use dcon::{Sensor, TypeCode};
use serde_json::{Value, json};
use thiserror::Error;

/// Temperatures without any in the arguments, C.
const USUAL_C: [f64; 6] = [0.0, 25.0, 50.0, 85.0, 100.0, 150.0];

/// Temperatures or signals to convert.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig bus sensor --type 22 45 85 120
  relayrig bus sensor --type 0F --signal 3.474
  relayrig bus sensor --type 22 --json

Connect a resistance decade or a voltage source in place of the sensor, set the printed signal, and compare the reading of the \
module. A voltage counts from a cold junction at 0 C: subtract that of the temperature of the terminals.

Exit status: 0 done, 2 bad input.")]
pub struct SensorArgs {
    /// Type code of the input, hexadecimal: Pt100 20 to 23, 2E, 80; type K 0F
    #[arg(long = "type", value_name = "CODE", value_parser = sensor)]
    sensor: Sensor,
    /// Convert this signal, ohm or mV, to a temperature; may be given several times
    #[arg(
        long,
        value_name = "VALUE",
        allow_negative_numbers = true,
        conflicts_with = "celsius"
    )]
    signal: Vec<f64>,
    /// One JSON object per row
    #[arg(long)]
    json: bool,
    /// Temperatures, C [default: 0 25 50 85 100 150]
    #[arg(value_name = "CELSIUS", allow_negative_numbers = true)]
    celsius: Vec<f64>,
}

/// The text is no type code of a sensor that is known here.
#[derive(Debug, Error)]
#[error("found \"{0}\", expected 20, 21, 22, 23, 2E, 80 or 0F")]
struct NoSensor(String);

fn sensor(text: &str) -> Result<Sensor, NoSensor> {
    let code = u8::from_str_radix(text, 16).ok().map(TypeCode);
    let found = code.and_then(Sensor::of);
    found.ok_or_else(|| NoSensor(text.to_owned()))
}

pub(super) fn run(args: &SensorArgs) -> anyhow::Result<Exit> {
    let unit = args.sensor.unit();
    let given = match (args.celsius.as_slice(), args.signal.as_slice()) {
        ([], []) => &USUAL_C[..],
        (celsius, _) => celsius,
    };
    let of_celsius = |celsius: &f64| {
        let signal = args.sensor.signal(*celsius);
        let signal = signal
            .with_context(|| format!("found {celsius} C, outside the range of the sensor"))?;
        anyhow::Ok([*celsius, signal])
    };
    let of_signal = |signal: &f64| {
        let celsius = args.sensor.celsius(*signal);
        let celsius = celsius
            .with_context(|| format!("found {signal} {unit}, outside the range of the sensor"))?;
        anyhow::Ok([celsius, *signal])
    };
    let given = given.iter().map(of_celsius);
    let rows: Vec<[f64; 2]> = given
        .chain(args.signal.iter().map(of_signal))
        .collect::<Result<_, _>>()?;
    let object = |[celsius, signal]: &[f64; 2]| -> Value {
        json!({"type": "sensor", "celsius": celsius, "signal": signal, "unit": unit})
    };
    let text = |[celsius, signal]: &[f64; 2]| format!("{celsius:>9.3} C {signal:>10.4} {unit}");
    Output::stdout().lines(args.json, &rows, object, text)?;
    Ok(Exit::Done)
}
