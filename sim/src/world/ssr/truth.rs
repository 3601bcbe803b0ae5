//! True figures of a solid-state relay under the keys of the truth file.

use serde::Serialize;

use super::defect::Defect;
use super::values::Values;
use crate::scpi::relay::Kind;

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
    /// Time from the control edge at the input pins to 90 % of the load voltage, us. Zero-cross: the control edge comes
    /// at the peak of the voltage over the output, and the time counts from the first zero after it; negative before
    /// that zero.
    pub t_on_us: Option<f64>,
    /// Time from the end of a long control pulse to 10 % of the load voltage, us. AC: the pulse ends at the peak of the
    /// current, and the time counts from the first zero of the current after that.
    pub t_off_us: Option<f64>,
    /// Drop at the rated current before the current has warmed the part, V. AC: at the peak of the current, mean of
    /// both directions.
    pub v_drop_v: Option<f64>,
    /// Leakage of the cold part at the rated voltage, uA. AC: rms, at the nominal line.
    pub i_leak_ua: Option<f64>,
    /// Leakage right after 200 ms of 1 A (AC: of the rated current), uA.
    pub i_leak_hot_ua: Option<f64>,
    /// Change of the drop at 1 A (AC: of the peak drop at the rated current), mV, from 10 ms to 200 ms after the
    /// current began in a cold part.
    pub drift_mv: Option<f64>,
    /// Figures that only a DC output has.
    #[serde(flatten)]
    pub dc: Option<DcTruth>,
    /// Figures that only an AC output has.
    #[serde(flatten)]
    pub ac: Option<AcTruth>,
}

/// Figures of a DC output.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct DcTruth {
    /// On-state resistance before the current has warmed the part, milliohm.
    pub r_on_mohm: Option<f64>,
}

/// Figures of an AC output.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct AcTruth {
    /// Rms drop at the rated current, V. The wait for firing at the beginning of each half cycle does not count.
    pub v_drop_rms_v: Option<f64>,
    /// Part of the leakage in phase with the voltage, uA, at the nominal line, in a cold part.
    pub i_leak_resistive_ua: Option<f64>,
    /// Part of the leakage that leads the voltage by a quarter of a cycle, uA.
    pub i_leak_capacitive_ua: Option<f64>,
    /// Highest voltage over the output at which it turns on first, V; `None` for an output designed to fire at any
    /// phase.
    pub v_zc_v: Option<f64>,
    /// Voltage over the output at which it fires in each later half cycle, V.
    pub v_retrig_v: Option<f64>,
    /// Mean voltage over the conducting output at the rated current, mV.
    pub dc_offset_mv: Option<f64>,
    /// Rms of the voltage over the conducting output without its fundamental, mV, at the rated current.
    pub wave_dist_mv: Option<f64>,
    /// Difference of the charges of both half cycles, divided by their sum, of the conducting output, %.
    pub halfwave_pct: Option<f64>,
}

/// Says which figures a part can have.
struct Shown {
    switches: bool,
    releases: bool,
    conducts: bool,
}

impl Shown {
    fn new(values: &Values, defect: Option<Defect>) -> Self {
        let model = &values.model;
        let lights = model.threshold_a.is_finite() && !model.open_led;
        let switches = lights && !model.shorted;
        Self {
            switches,
            releases: switches && defect != Some(Defect::StuckOn),
            conducts: lights || model.shorted,
        }
    }
}

fn when(shown: bool, figure: f64) -> Option<f64> {
    (shown && figure.is_finite()).then_some(figure)
}

impl SsrTruth {
    /// Computes the figures; `loop_ohm` is the resistance of the loop of the rated alternating current.
    pub fn new(values: &Values, defect: Option<Defect>, loop_ohm: f64) -> Self {
        let shown = Shown::new(values, defect);
        let control = Self::of_control(values, &shown);
        match values.model.kind {
            Kind::Dc | Kind::Passive => control.with_dc(values, &shown),
            Kind::AcZeroCross | Kind::AcRandom => control.with_ac(values, &shown, loop_ohm),
        }
    }

    fn of_control(values: &Values, shown: &Shown) -> Self {
        let (model, rated, celsius) = (&values.model, &values.rated, values.celsius);
        let input = |volts: f64| Some(model.input_a(volts, 0.0, celsius).abs());
        let threshold_a = model.threshold_at(celsius);
        let off_a = threshold_a * model.hysteresis;
        Self {
            v_on_v: when(shown.switches, model.input_v(threshold_a, celsius)),
            v_off_v: when(shown.releases, model.input_v(off_a, celsius)),
            i_in_ma: input(rated.control_v).map(|amps| amps * 1e3),
            i_rev_ua: input(-rated.control_v).map(|amps| amps * 1e6),
            ..Self::default()
        }
    }

    fn with_dc(self, values: &Values, shown: &Shown) -> Self {
        let (celsius, warm) = (values.celsius, values.warm_up());
        let leak_ua = |celsius| values.blocked_siemens(celsius) * values.rated.blocked_v * 1e6;
        let on_ohm = values.on_ohm(celsius);
        Self {
            t_on_us: when(shown.switches, values.turn_on_s() * 1e6),
            t_off_us: when(shown.releases, values.turn_off_s() * 1e6),
            v_drop_v: when(shown.conducts, on_ohm * values.rated.load_a),
            i_leak_ua: when(!values.model.shorted, leak_ua(celsius)),
            i_leak_hot_ua: when(shown.switches, leak_ua(warm.junction_c)),
            drift_mv: when(shown.switches, warm.drift_v * 1e3),
            dc: Some(DcTruth {
                r_on_mohm: when(shown.conducts, on_ohm * 1e3),
            }),
            ..self
        }
    }

    fn with_ac(self, values: &Values, shown: &Shown, loop_ohm: f64) -> Self {
        let (celsius, warm) = (values.celsius, values.ac_warm_up());
        let blocks = !values.model.shorted && values.half_short == 0.0;
        let (switches, hot_c) = (shown.switches, warm.junction_c);
        Self {
            t_on_us: when(switches, values.ac_turn_on_s() * 1e6),
            t_off_us: when(shown.releases && blocks, values.ac_turn_off_s() * 1e6),
            v_drop_v: when(switches, values.peak_drop_v(celsius)),
            i_leak_ua: when(blocks, values.leakage_a(celsius) * 1e6),
            i_leak_hot_ua: when(switches && blocks, values.leakage_a(hot_c) * 1e6),
            drift_mv: when(switches, warm.drift_v * 1e3),
            ac: Some(AcTruth::new(values, switches, blocks, loop_ohm)),
            ..self
        }
    }
}

impl AcTruth {
    fn new(values: &Values, switches: bool, blocks: bool, loop_ohm: f64) -> Self {
        let (celsius, cycle) = (values.celsius, values.on_cycle(loop_ohm));
        let waits = switches && blocks;
        let is_zero_cross = values.model.kind == Kind::AcZeroCross;
        Self {
            v_drop_rms_v: when(switches, values.rms_drop_v(celsius)),
            i_leak_resistive_ua: when(blocks, values.resistive_a(celsius) * 1e6),
            i_leak_capacitive_ua: when(blocks, values.capacitive_a() * 1e6),
            v_zc_v: when(waits && is_zero_cross, values.zero_cross_v()),
            v_retrig_v: when(waits, values.model.retrigger_v),
            dc_offset_mv: when(switches, cycle.offset_v * 1e3),
            wave_dist_mv: when(switches, cycle.distortion_v * 1e3),
            halfwave_pct: when(switches, cycle.halfwave * 100.0),
        }
    }
}
