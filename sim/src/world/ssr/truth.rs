//! True figures of a solid-state relay under the keys of the truth file.

use serde::Serialize;

use super::defect::Defect;
use super::values::Values;

/// Figures by their definitions; `None` where the part cannot show the figure.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct SsrTruth {
    /// Control voltage at and above which the output conducts in the end, V.
    pub v_on_v: Option<f64>,
    /// Control voltage below which a conducting output blocks in the end, V.
    pub v_off_v: Option<f64>,
    /// Input current at the nominal control voltage, mA.
    pub i_in_ma: Option<f64>,
    /// Size of the input current at the reversed nominal control voltage, uA.
    pub i_rev_ua: Option<f64>,
    /// From the control edge, at the input pins, to 90 % of the load voltage, us.
    pub t_on_us: Option<f64>,
    /// From the end of a long control pulse to 10 % of the load voltage, us.
    pub t_off_us: Option<f64>,
    /// Drop at the rated current before the current has warmed the part, V.
    pub v_drop_v: Option<f64>,
    /// On-state resistance before the current has warmed the part, milliohm.
    pub r_on_mohm: Option<f64>,
    /// Current of the blocked output at the rated voltage, the part cold, uA.
    pub i_leak_ua: Option<f64>,
    /// The same at the end of 200 ms of 1 A, uA.
    pub i_leak_hot_ua: Option<f64>,
    /// Change of the drop at 1 A from 10 ms to 200 ms after it began in a cold part, mV.
    pub drift_mv: Option<f64>,
}

impl SsrTruth {
    /// Computes the figures.
    pub fn new(values: &Values, defect: Option<Defect>) -> Self {
        let (model, rated, celsius) = (&values.model, &values.rated, values.celsius);
        let size = |amps: f64| Some(amps.abs());
        let input = |volts: f64| size(model.input_a(volts, 0.0, celsius));
        let lights = model.threshold_a.is_finite() && !model.open_led;
        let switches = lights && !model.shorted;
        let releases = switches && defect != Some(Defect::StuckOn);
        let conducts = lights || model.shorted;
        let threshold_a = model.threshold_at(celsius);
        let warm = values.warm_up();
        let leak_ua = |celsius| values.blocked_siemens(celsius) * rated.blocked_v * 1e6;
        let on_ohm = values.on_ohm(celsius);
        let when = |shown: bool, figure: f64| (shown && figure.is_finite()).then_some(figure);
        Self {
            v_on_v: when(switches, model.input_v(threshold_a, celsius)),
            v_off_v: when(
                releases,
                model.input_v(threshold_a * model.hysteresis, celsius),
            ),
            i_in_ma: input(rated.control_v).map(|amps| amps * 1e3),
            i_rev_ua: input(-rated.control_v).map(|amps| amps * 1e6),
            t_on_us: when(switches, values.turn_on_s() * 1e6),
            t_off_us: when(releases, values.turn_off_s() * 1e6),
            v_drop_v: when(conducts, on_ohm * rated.load_a),
            r_on_mohm: when(conducts, on_ohm * 1e3),
            i_leak_ua: when(!model.shorted, leak_ua(celsius)),
            i_leak_hot_ua: when(switches, leak_ua(warm.junction_c)),
            drift_mv: when(switches, warm.drift_v * 1e3),
        }
    }
}
