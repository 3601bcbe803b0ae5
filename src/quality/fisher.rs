//! Upper tail of the F distribution, for the question whether an effect is more than chance.
//!
//! `P(F > f) = I_x(d2 / 2, d1 / 2)` with `x = d2 / (d2 + d1 f)`, the regularised incomplete beta
//! function by its continued fraction (Lentz), the logarithm of gamma by Lanczos' series (g = 7, nine
//! terms, about 15 digits).

/// Probability that F with `d1` and `d2` degrees of freedom exceeds `f`. 1 for `f <= 0`.
pub fn upper_tail(f: f64, d1: f64, d2: f64) -> f64 {
    if f <= 0.0 {
        return 1.0;
    }
    if f.is_infinite() {
        return 0.0;
    }
    incomplete_beta(d2 / (d2 + d1 * f), d2 / 2.0, d1 / 2.0)
}

fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    let front = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p();
    // The fraction converges quickly on this side only; the other follows by symmetry.
    if x < (a + 1.0) / (a + b + 2.0) {
        front.exp() * fraction(x, a, b) / a
    } else {
        1.0 - front.exp() * fraction(1.0 - x, b, a) / b
    }
}

/// Enough for degrees of freedom up to some millions.
const TERMS: u32 = 10_000;

fn fraction(x: f64, a: f64, b: f64) -> f64 {
    let guard = |it: f64| if it.abs() < 1e-300 { 1e-300 } else { it };
    let mut c = 1.0;
    let mut d = 1.0 / guard(1.0 - (a + b) * x / (a + 1.0));
    let mut result = d;
    for term in 1..=TERMS {
        let m = f64::from(term);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = result;
        for coefficient in [even, odd] {
            d = 1.0 / guard(1.0 + coefficient * d);
            c = guard(1.0 + coefficient / c);
            result *= d * c;
        }
        if (result - before).abs() <= 1e-15 * result.abs() {
            break;
        }
    }
    result
}

#[allow(clippy::excessive_precision, reason = "the published coefficients")]
const LANCZOS: [f64; 9] = [
    0.999_999_999_999_809_93,
    676.520_368_121_885_1,
    -1_259.139_216_722_402_8,
    771.323_428_777_653_13,
    -176.615_029_162_140_59,
    12.507_343_278_686_905,
    -0.138_571_095_265_720_12,
    9.984_369_578_019_571_6e-6,
    1.505_632_735_149_311_6e-7,
];

/// For arguments of one half and more.
fn ln_gamma(x: f64) -> f64 {
    let x = x - 1.0;
    let series: f64 = (1..9).map(|n| LANCZOS[n] / (x + n as f64)).sum::<f64>() + LANCZOS[0];
    let t = x + 7.5;
    0.5 * (2.0 * std::f64::consts::PI).ln() + (x + 0.5) * t.ln() - t + series.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_percent_points_of_the_tables_come_back() {
        for (f, d1, d2) in [
            (161.448, 1.0, 1.0),
            (4.9646, 1.0, 10.0),
            (2.7109, 5.0, 20.0),
            (1.7784, 18.0, 60.0),
        ] {
            let p = upper_tail(f, d1, d2);
            assert!((p - 0.05).abs() < 2e-5, "F({d1}, {d2}) = {f}: {p}");
        }
    }

    #[test]
    fn two_and_two_degrees_have_a_closed_form() {
        for f in [0.01, 0.5, 1.0, 9.0, 1e6] {
            assert!((upper_tail(f, 2.0, 2.0) - 1.0 / (1.0 + f)).abs() < 1e-14);
        }
    }
}
