//! Pt100 of IEC 60751: the equation of Callendar and Van Dusen, both ways.

const A: f64 = 3.9083e-3;
const B: f64 = -5.775e-7;
const C: f64 = -4.183e-12;
const R0_OHM: f64 = 100.0;
/// Range of the standard, C.
const RANGE_C: [f64; 2] = [-200.0, 850.0];

/// Returns the resistance at a temperature, ohm; `None` outside -200 to 850 C.
pub fn ohm(celsius: f64) -> Option<f64> {
    let within = (RANGE_C[0]..=RANGE_C[1]).contains(&celsius);
    let cold = if celsius < 0.0 {
        C * (celsius - 100.0) * celsius.powi(3)
    } else {
        0.0
    };
    within.then_some(R0_OHM * (1.0 + A * celsius + B * celsius * celsius + cold))
}

/// Returns the temperature for a resistance, C; `None` outside -200 to 850 C.
pub fn celsius(ohm: f64) -> Option<f64> {
    let warm = (-A + (A * A - 4.0 * B * (1.0 - ohm / R0_OHM)).sqrt()) / (2.0 * B);
    let found = if ohm >= R0_OHM { warm } else { cold(ohm, warm) };
    (RANGE_C[0] - 1e-6..=RANGE_C[1] + 1e-6)
        .contains(&found)
        .then_some(found)
}

/// Solves the equation below 0 C by Newton's method, from the solution without the term of Van Dusen.
fn cold(ohm: f64, mut celsius: f64) -> f64 {
    for _ in 0..8 {
        let cubic = C * (celsius - 100.0) * celsius.powi(3);
        let found = R0_OHM * (1.0 + A * celsius + B * celsius * celsius + cubic);
        let steep = A + 2.0 * B * celsius + C * celsius * celsius * (4.0 * celsius - 300.0);
        celsius -= (found - ohm) / (R0_OHM * steep);
    }
    celsius
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn both_ways_give_the_values_of_the_standard() {
        let table = [
            (-200.0, 18.5201),
            (-50.0, 80.3063),
            (-20.0, 92.1599),
            (0.0, 100.0),
            (10.0, 103.9025),
            (25.0, 109.7347),
            (50.0, 119.3971),
            (85.0, 132.8033),
            (100.0, 138.5055),
            (150.0, 157.3251),
            (200.0, 175.8560),
        ];
        for (at_c, expected) in table {
            let found = ohm(at_c).unwrap();
            assert!((found - expected).abs() < 6e-5, "{at_c}: {found}");
            assert!((celsius(found).unwrap() - at_c).abs() < 1e-6);
        }
    }

    #[test]
    fn a_short_and_an_open_wire_have_no_temperature() {
        assert_eq!([celsius(0.0), celsius(1e6), celsius(f64::NAN)], [None; 3]);
        assert_eq!([ohm(-201.0), ohm(f64::INFINITY)], [None; 2]);
    }
}
