//! Model of a conducting output: how far its voltage differs from a sine. In each half cycle the output waits until the
//! source reaches the voltage at which it fires; then it has its drop until the current ends.

use std::f64::consts::TAU;

/// Points of a computed period. A jump lies between two of them, so they are many.
const POINTS: u32 = 8_000;

/// A conducting output and its load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conducting {
    /// Drop without current, V.
    pub threshold_v: f64,
    /// Rise of the drop with the current, ohm.
    pub ohm: f64,
    /// Voltage at which the output fires, V.
    pub fires_v: f64,
    /// Resistance of the load, ohm.
    pub load_ohm: f64,
}

impl Conducting {
    /// Returns the sine of a source that drives a current with this peak through output and load, by turns.
    pub fn sine(&self, peak_a: f64) -> impl Fn(f64) -> f64 + use<> {
        let peak_v = self.threshold_v + (self.ohm + self.load_ohm) * peak_a;
        move |turns| peak_v * (TAU * turns).sin()
    }

    /// Returns the rms of the voltage over one period without its mean and its fundamental, V. `source` returns the voltage
    /// of the source at a number of turns after one of its zeros.
    pub fn distortion_v(&self, source: impl Fn(f64) -> f64) -> f64 {
        let [mut sum, mut sine, mut cosine, mut squares] = [0.0; 4];
        for point in 0..POINTS {
            let turns = (f64::from(point) + 0.5) / f64::from(POINTS);
            let volts = self.at(source(turns), (2.0 * turns).fract() < 0.5);
            let (sin, cos) = (TAU * turns).sin_cos();
            sum += volts;
            sine += volts * sin;
            cosine += volts * cos;
            squares += volts * volts;
        }
        let [mean, sine, cosine, square] =
            [sum, sine, cosine, squares].map(|it| it / f64::from(POINTS));
        let distorted = square - mean * mean - 2.0 * (sine * sine + cosine * cosine);
        distorted.max(0.0).sqrt()
    }

    /// Returns the voltage of the output at a voltage of the source that rises or falls, V.
    fn at(&self, source_v: f64, rises: bool) -> f64 {
        let waits_to_v = if rises { self.fires_v } else { 0.0 };
        if source_v.abs() < waits_to_v.max(self.threshold_v) {
            return source_v;
        }
        let ampere = (source_v.abs() - self.threshold_v) / (self.load_ohm + self.ohm);
        (self.threshold_v + self.ohm * ampere).copysign(source_v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTPUT: Conducting = Conducting {
        threshold_v: 0.85,
        ohm: 0.045,
        fires_v: 0.0,
        load_ohm: 4.7,
    };

    #[test]
    fn an_output_that_never_waits_has_the_distortion_of_a_square_wave() {
        // A source far above the drop: the ramps hardly count, and the load takes its share of each jump.
        let jump_v = OUTPUT.threshold_v * OUTPUT.load_ohm / (OUTPUT.load_ohm + OUTPUT.ohm);
        let square_v = (1.0 - 32.0 / (TAU * TAU)).sqrt() * jump_v;
        let distortion_v = OUTPUT.distortion_v(OUTPUT.sine(1e4));
        assert!(
            (distortion_v / square_v - 1.0).abs() < 2e-3,
            "{distortion_v} {square_v}"
        );
    }

    #[test]
    fn waiting_distorts_more_and_a_steep_source_less() {
        let waits = Conducting {
            fires_v: 4.0,
            ..OUTPUT
        };
        let sine = waits.sine(7.07);
        let distortion_v = waits.distortion_v(&sine);
        assert!(distortion_v > 1.2 * OUTPUT.distortion_v(OUTPUT.sine(7.07)));
        let steep = |turns: f64| sine(turns) + 0.5 * (3.0 * TAU * turns).sin();
        assert!(waits.distortion_v(steep) < distortion_v);
    }
}
