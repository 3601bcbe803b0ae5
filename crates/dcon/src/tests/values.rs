//! Tests of numbers: readings, levels, configuration words.

use super::*;

#[test]
fn readings_are_numbers_in_their_notation() {
    for (form, text, value, volts) in [
        (VOLTS, ">+02.513", Value::Engineering(2.513), Some(2.513)),
        (VOLTS, ">-10.000", Value::Engineering(-10.0), Some(-10.0)),
        (PERCENT, ">+050.00", Value::Percent(50.0), Some(5.0)),
        (HEX, ">4000", Value::Hex(0x4000), Some(5.0)),
        (HEX, ">C000", Value::Hex(-0x4000), Some(-5.0)),
        (VOLTS, ">       ", Value::Blank, None),
        (HEX, ">    ", Value::Blank, None),
    ] {
        assert_eq!(read_one(form, text), Ok(value), "{text}");
        assert_eq!(value.in_units(form.range), volts, "{text}");
    }
}

#[test]
fn a_reading_at_full_scale_hex_is_no_number() {
    for (form, text, value) in [
        (VOLTS, ">+9999.9", Value::OverRange),
        (VOLTS, ">9999.9", Value::OverRange),
        (VOLTS, ">-9999.9", Value::UnderRange),
        (PERCENT, ">+999.99", Value::OverRange),
        (PERCENT, ">-999.99", Value::UnderRange),
        (HEX, ">7FFF", Value::OverRange),
        (HEX, ">8000", Value::UnderRange),
    ] {
        assert_eq!(read_one(form, text), Ok(value), "{text}");
        assert_eq!(value.in_units(form.range), None, "{text}");
    }
}

#[test]
fn temperatures_in_hex_are_shares_of_full_scale() {
    for (code, text, celsius) in [
        (0x22, ">3600", Some(84.375)),
        (0x22, ">7FFE", Some(199.9878)),
        (0x22, ">0001", Some(0.0061)),
        (0x20, ">E000", Some(-25.0)),
        (0x0F, ">0800", Some(85.75)),
        (0x0F, ">E6D0", Some(-269.9785)),
        (0x22, ">7FFF", None),
        (0x22, ">FFFF", None),
        (0x22, ">0000", None),
        (0x22, ">8000", None),
        (0x22, ">FFF0", None),
    ] {
        let form = InputForm::three(DataFormat::Hex, TypeCode(code));
        let found = read_one(form, text).unwrap().in_units(form.range);
        let same = match (found, celsius) {
            (Some(found), Some(celsius)) => (found - celsius).abs() < 1e-3,
            (found, celsius) => found == celsius,
        };
        assert!(same, "{code:02X} {text}: {found:?}");
    }
}

#[test]
fn short_codes_of_broken_sensors_are_no_numbers() {
    let form = InputForm::three(DataFormat::Engineering, TypeCode(0x22));
    for text in [">+9999", ">-0000", ">+9999.9", ">-9999.9"] {
        let value = read_one(form, text).ok();
        let number = value.and_then(|it| it.in_units(form.range));
        assert_eq!(number, None, "{text}");
    }
}

#[test]
fn a_reading_beyond_its_range_is_refused() {
    for (form, text) in [
        (VOLTS, ">+99.000"),
        (VOLTS, ">+2.5.13"),
        (VOLTS, ">+025131"),
        (VOLTS, "> 02.513"),
        (PERCENT, ">+500.00"),
        (PERCENT, ">+50.000"),
        (HEX, ">4c53"),
        (HEX, ">4C 3"),
    ] {
        assert!(read_one(form, text).is_err(), "{text}");
    }
}

#[test]
fn all_channels_come_in_order_with_disabled_ones_blank() {
    let (command, reply) = READINGS[1];
    let Ok(Reply::Readings(all)) = command.decode(&sealed(reply, true), true) else {
        panic!("{reply}")
    };
    assert_eq!(all.get(0).unwrap().value, Value::Engineering(5.123));
    assert_eq!(all.get(1).unwrap().value, Value::Blank);
    assert_eq!(all.get(7).unwrap().text(), "+08.234");
    assert_eq!(all.iter().count(), 8);
    let Ok(Reply::Readings(three)) = READINGS[5].0.decode(&sealed(READINGS[5].1, true), true)
    else {
        panic!()
    };
    assert_eq!(
        three.get(2).unwrap().value.in_units(TypeCode(0x20)),
        Some(99.99)
    );
    assert_eq!(three.get(3), None);
}

#[test]
fn an_unreachable_level_is_refused_before_sending() {
    let volts = TypeCode(0x32);
    assert_eq!(
        Level::nearest(OutputForm::Hex16, volts, 10.0)
            .unwrap()
            .steps(),
        0xFFFF
    );
    assert_eq!(
        Level::nearest(OutputForm::Hex12, volts, 5.0)
            .unwrap()
            .steps(),
        0x800
    );
    assert_eq!(
        Level::nearest(OutputForm::Engineering, volts, 5.0004)
            .unwrap()
            .steps(),
        5000
    );
    assert_eq!(
        Level::nearest(OutputForm::Percent, TypeCode(0x31), 4.0)
            .unwrap()
            .steps(),
        0
    );
    let outside = LevelError::OutOfRange {
        value: 10.1,
        low: 0.0,
        high: 10.0,
    };
    assert_eq!(Level::nearest(OutputForm::Hex16, volts, 10.1), Err(outside));
    assert!(Level::nearest(OutputForm::Hex16, volts, f64::NAN).is_err());
    assert!(Level::nearest(OutputForm::Hex16, TypeCode(0x40), 1.0).is_err());
    for volts_wanted in [0.0, 0.3, 7.777, 10.0] {
        let level = Level::nearest(OutputForm::Hex16, volts, volts_wanted).unwrap();
        assert!(
            (level.in_units(volts).unwrap() - volts_wanted).abs() <= 10.0 / 65535.0 / 2.0 + 1e-12
        );
    }
}

#[test]
fn the_configuration_word_gives_baud_filter_and_slew() {
    let config = config(0x32, 0x0A, 0x54);
    assert_eq!(config.baud.rate(), Some(115_200));
    assert_eq!(BaudCode::of(9_600), Some(BaudCode(6)));
    assert!(config.format.checksum());
    assert_eq!(config.format.slew().volt_per_second(), Some(1.0));
    assert_eq!(FormatByte(0x2E).slew().volt_per_second(), Some(64.0));
    assert!(FormatByte(0x22).fast() && FormatByte(0x22).data_format() == Some(DataFormat::Hex));
    assert_eq!(SlewCode::IMMEDIATE.volt_per_second(), None);
}
