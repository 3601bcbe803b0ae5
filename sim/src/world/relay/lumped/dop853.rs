//! One step of the explicit Runge-Kutta method of order 8 by Dormand and Prince, with error estimates of orders 5
//! and 3.
//!
//! Coefficients: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), II.5.
//! The fast motions of a relay oscillate rather than decay, and the steps must resolve them anyway, so an
//! explicit method of high order is cheaper than an implicit one.

#![allow(clippy::excessive_precision)] // as printed in the book

use super::State;

/// Instants of the stages as fractions of the step; the first stage is the slope at the start.
const C: [f64; 10] = [
    0.526001519587677318785587544488e-1,
    0.789002279381515978178381316732e-1,
    0.118350341907227396726757197510,
    0.281649658092772603273242802490,
    0.333333333333333333333333333333,
    0.25,
    0.307692307692307692307692307692,
    0.651282051282051282051282051282,
    0.6,
    0.857142857142857142857142857142,
];
const A2: [f64; 1] = [5.26001519587677318785587544488e-2];
const A3: [f64; 2] = [
    1.97250569845378994544595329183e-2,
    5.91751709536136983633785987549e-2,
];
const A4: [f64; 2] = [
    2.95875854768068491816892993775e-2,
    8.87627564304205475450678981324e-2,
];
const A5: [f64; 3] = [
    2.41365134159266685502369798665e-1,
    -8.84549479328286085344864962717e-1,
    9.24834003261792003115737966543e-1,
];
const A6: [f64; 3] = [
    3.7037037037037037037037037037e-2,
    1.70828608729473871279604482173e-1,
    1.25467687566822425016691814123e-1,
];
const A7: [f64; 4] = [
    3.7109375e-2,
    1.70252211019544039314978060272e-1,
    6.02165389804559606850219397283e-2,
    -1.7578125e-2,
];
const A8: [f64; 5] = [
    3.70920001185047927108779319836e-2,
    1.70383925712239993810214054705e-1,
    1.07262030446373284651809199168e-1,
    -1.53194377486244017527936158236e-2,
    8.27378916381402288758473766002e-3,
];
const A9: [f64; 6] = [
    6.24110958716075717114429577812e-1,
    -3.36089262944694129406857109825,
    -8.68219346841726006818189891453e-1,
    2.75920996994467083049415600797e1,
    2.01540675504778934086186788979e1,
    -4.34898841810699588477366255144e1,
];
const A10: [f64; 7] = [
    4.77662536438264365890433908527e-1,
    -2.48811461997166764192642586468,
    -5.90290826836842996371446475743e-1,
    2.12300514481811942347288949897e1,
    1.52792336328824235832596922938e1,
    -3.32882109689848629194453265587e1,
    -2.03312017085086261358222928593e-2,
];
const A11: [f64; 8] = [
    -9.3714243008598732571704021658e-1,
    5.18637242884406370830023853209,
    1.09143734899672957818500254654,
    -8.14978701074692612513997267357,
    -1.85200656599969598641566180701e1,
    2.27394870993505042818970056734e1,
    2.49360555267965238987089396762,
    -3.0467644718982195003823669022,
];
const A12: [f64; 9] = [
    2.27331014751653820792359768449,
    -1.05344954667372501984066689879e1,
    -2.00087205822486249909675718444,
    -1.79589318631187989172765950534e1,
    2.79488845294199600508499808837e1,
    -2.85899827713502369474065508674,
    -8.87285693353062954433549289258,
    1.23605671757943030647266201528e1,
    6.43392746015763530355970484046e-1,
];
/// Weights of stages 1 and 6 to 12.
const B: [f64; 8] = [
    5.42937341165687622380535766363e-2,
    4.45031289275240888144113950566,
    1.89151789931450038304281599044,
    -5.8012039600105847814672114227,
    3.1116436695781989440891606237e-1,
    -1.52160949662516078556178806805e-1,
    2.01365400804030348374776537501e-1,
    4.47106157277725905176885569043e-2,
];
/// Differences between the weights of orders 8 and 5, for the same stages.
const E5: [f64; 8] = [
    0.1312004499419488073250102996e-1,
    -0.1225156446376204440720569753e1,
    -0.4957589496572501915214079952,
    0.1664377182454986536961530415e1,
    -0.3503288487499736816886487290,
    0.3341791187130174790297318841,
    0.8192320648511571246570742613e-1,
    -0.2235530786388629525884427845e-1,
];
/// Weights of order 3: stages 1, 9 and 12.
const B3: [f64; 3] = [
    0.244094488188976377952755905512,
    0.733846688281611857341361741547,
    0.220588235294117647058823529412e-1,
];

/// Number of evaluations per step; the slope at the start is already known.
pub const EVALUATIONS: u64 = 11;

/// Result of a trial step.
#[derive(Debug, Clone, Copy)]
pub struct TrialStep {
    /// State at the end of the step.
    pub state: State,
    /// Error relative to the tolerance; up to 1 is acceptable.
    pub error: f64,
}

#[inline(always)]
fn blend<const N: usize>(weights: &[f64; N], slopes: [&State; N]) -> State {
    let mut sum = [0.0; 5];
    for (weight, slope) in weights.iter().zip(slopes) {
        for (total, rate) in sum.iter_mut().zip(slope) {
            *total += weight * rate;
        }
    }
    sum
}

/// Returns the state after `h` seconds along weighted slopes. The latest slope must come last: then only one product
/// and one sum wait for it.
#[inline(always)]
fn along<const N: usize>(from: &State, h: f64, weights: &[f64; N], slopes: [&State; N]) -> State {
    let mut to = *from;
    for (weight, slope) in weights.iter().zip(slopes) {
        let share = h * weight;
        for (value, rate) in to.iter_mut().zip(slope) {
            *value += share * rate;
        }
    }
    to
}

/// Takes a trial step of `h` seconds from state `s` at time `t` with the slope `k1`; `scale` is the permitted error of
/// each state, absolute and relative.
#[inline]
pub fn step(
    f: impl Fn(f64, &State) -> State,
    [t, h]: [f64; 2],
    s: &State,
    k1: &State,
    scale: &Tolerance,
) -> TrialStep {
    let at = |i: usize| t + C[i] * h;
    let k2 = f(at(0), &along(s, h, &A2, [k1]));
    let k3 = f(at(1), &along(s, h, &A3, [k1, &k2]));
    let k4 = f(at(2), &along(s, h, &A4, [k1, &k3]));
    let k5 = f(at(3), &along(s, h, &A5, [k1, &k3, &k4]));
    let k6 = f(at(4), &along(s, h, &A6, [k1, &k4, &k5]));
    let k7 = f(at(5), &along(s, h, &A7, [k1, &k4, &k5, &k6]));
    let k8 = f(at(6), &along(s, h, &A8, [k1, &k4, &k5, &k6, &k7]));
    let k9 = f(at(7), &along(s, h, &A9, [k1, &k4, &k5, &k6, &k7, &k8]));
    let k10 = f(
        at(8),
        &along(s, h, &A10, [k1, &k4, &k5, &k6, &k7, &k8, &k9]),
    );
    let k11 = f(
        at(9),
        &along(s, h, &A11, [k1, &k4, &k5, &k6, &k7, &k8, &k9, &k10]),
    );
    let stages = [k1, &k4, &k5, &k6, &k7, &k8, &k9, &k10, &k11];
    let k12 = f(t + h, &along(s, h, &A12, stages));
    let last = [k1, &k6, &k7, &k8, &k9, &k10, &k11, &k12];
    let slope = blend(&B, last);
    let state = along(s, h, &[1.0], [&slope]);
    let low = blend(&B3, [k1, &k9, &k12]);
    TrialStep {
        state,
        error: scale.error(h, s, &state, &blend(&E5, last), &slope, &low),
    }
}

/// Permitted error of a step, relative to the sum of each state and its natural size.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    /// Permitted error as a fraction of that sum.
    pub relative: f64,
}

/// Natural sizes of the five states: V s, m, m/s, m, m/s.
const SIZE: State = [1e-2, 1e-5, 1e-1, 1e-5, 1e-1];

impl Tolerance {
    #[inline]
    fn error(self, h: f64, from: &State, to: &State, e5: &State, b8: &State, b3: &State) -> f64 {
        let (mut five, mut three) = (0.0, 0.0);
        for i in 0..5 {
            let may = self.relative * (SIZE[i] + from[i].abs().max(to[i].abs()));
            five += (e5[i] / may).powi(2);
            three += ((b8[i] - b3[i]) / may).powi(2);
        }
        let both = five + 0.01 * three;
        match both > 0.0 {
            true => h * five / (both * 5.0).sqrt(),
            false if both == 0.0 => 0.0,
            false => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stage_instant_is_the_sum_of_its_weights() {
        let sums = [
            A2.iter().sum::<f64>(),
            A3.iter().sum(),
            A4.iter().sum(),
            A5.iter().sum(),
            A6.iter().sum(),
            A7.iter().sum(),
            A8.iter().sum(),
            A9.iter().sum(),
            A10.iter().sum(),
            A11.iter().sum(),
        ];
        for (sum, at) in sums.iter().zip(C) {
            assert!((sum - at).abs() < 2e-14, "{sum} {at}");
        }
        let whole = [A12.iter().sum::<f64>(), B.iter().sum(), B3.iter().sum()];
        assert!(whole.iter().all(|w| (w - 1.0).abs() < 2e-14), "{whole:?}");
        assert!(E5.iter().sum::<f64>().abs() < 2e-14);
    }

    #[test]
    fn halving_the_step_divides_the_error_by_512() {
        let swing = |_: f64, s: &State| [0.0, s[2], -s[1] - s[1].powi(3), 0.0, 0.0];
        let from = [0.0, 1.0, 0.0, 0.0, 0.0];
        let any = Tolerance { relative: 1.0 };
        let one = |h: f64, parts: usize| {
            let mut s = from;
            for i in 0..parts {
                let part = h / parts as f64;
                s = step(swing, [i as f64 * part, part], &s, &swing(0.0, &s), &any).state;
            }
            s[1]
        };
        let error = |h: f64| (one(h, 1) - one(h, 40)).abs();
        let order = (error(0.8) / error(0.4)).log2();
        assert!((8.5..10.0).contains(&order), "local order {order}");
    }
}
