//! Encodes a request to an I-7017 and decodes the reply: `cargo run -p dcon --example read_voltage`.

use dcon::{Address, AnalogIn, Command, DataFormat, InputForm, Reply, TypeCode};

/// Type code of the range -10 to 10 V.
const TEN_VOLTS: TypeCode = TypeCode(0x08);

fn main() {
    let question = Command::AnalogIn(
        Address(0x03),
        AnalogIn::ReadAll(InputForm::eight(DataFormat::Engineering, TEN_VOLTS)),
    );
    let mut request = Vec::new();
    question.encode(false, &mut request);
    println!("request  {}", request.escape_ascii());

    for frame in [
        ">+02.513+00.000-01.250+09.999+00.001+00.000+00.000+00.000\r",
        ">+02.513\r",
    ] {
        match question.decode(frame.as_bytes(), false) {
            Ok(Reply::Readings(readings)) => {
                let volts: Vec<_> = readings
                    .iter()
                    .filter_map(|reading| reading.value.in_units(TEN_VOLTS))
                    .collect();
                println!("reply    {volts:?} V");
            }
            Ok(other) => println!("reply    {other:?}"),
            Err(error) => println!("refused  {}: {error}", frame.escape_default()),
        }
    }
}
