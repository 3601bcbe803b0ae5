//! Thermocouple of type K, from 0 to 500 C: the reference function of ITS-90 and its inverse.

/// Coefficients of the voltage, mV, by power of the temperature.
const VOLTAGE: [f64; 10] = [
    -1.7600413686e-2,
    3.8921204975e-2,
    1.8558770032e-5,
    -9.9457592874e-8,
    3.1840945719e-10,
    -5.6072844889e-13,
    5.6075059059e-16,
    -3.2020720003e-19,
    9.7151147152e-23,
    -1.2104721275e-26,
];
/// Coefficients of the temperature, C, by power of the voltage.
const TEMPERATURE: [f64; 10] = [
    0.0,
    25.08355,
    7.860106e-2,
    -2.503131e-1,
    8.315270e-2,
    -1.228034e-2,
    9.804036e-4,
    -4.413030e-5,
    1.057734e-6,
    -1.052755e-8,
];
/// Range of both functions, C.
const RANGE_C: std::ops::RangeInclusive<f64> = 0.0..=500.0;
/// Range of the voltage, mV.
const RANGE_MV: std::ops::RangeInclusive<f64> = 0.0..=20.644;

/// Returns the voltage at a temperature, mV, with the cold junction at 0 C; `None` outside 0 to 500 C.
pub fn millivolt(celsius: f64) -> Option<f64> {
    let bump = 0.1185976 * (-1.183432e-4 * (celsius - 126.9686).powi(2)).exp();
    RANGE_C
        .contains(&celsius)
        .then(|| polynomial(&VOLTAGE, celsius) + bump)
}

/// Returns the temperature for a voltage, C, with the cold junction at 0 C; off by 0.05 K at most. `None` outside 0 to
/// 500 C.
pub fn celsius(millivolt: f64) -> Option<f64> {
    RANGE_MV
        .contains(&millivolt)
        .then(|| polynomial(&TEMPERATURE, millivolt))
}

fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, it| sum * x + it)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_reference_function_gives_the_published_values() {
        let table = [
            (10.0, 0.397),
            (25.0, 1.000),
            (50.0, 2.023),
            (85.0, 3.474),
            (100.0, 4.096),
            (150.0, 6.138),
            (200.0, 8.138),
            (300.0, 12.209),
            (500.0, 20.644),
        ];
        for (at_c, expected) in table {
            let found = millivolt(at_c).unwrap();
            assert!((found - expected).abs() < 6e-4, "{at_c}: {found}");
        }
    }

    #[test]
    fn the_inverse_is_off_by_a_twentieth_of_a_kelvin() {
        for at_c in 1..500 {
            let at_c = f64::from(at_c);
            let found = celsius(millivolt(at_c).unwrap()).unwrap();
            assert!((found - at_c).abs() < 0.05, "{at_c}: {found}");
        }
    }

    #[test]
    fn a_voltage_outside_the_range_has_no_temperature() {
        assert_eq!([celsius(-0.1), celsius(21.0), celsius(f64::NAN)], [None; 3]);
    }
}
