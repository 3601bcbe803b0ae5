//! Descriptions of requests. Two requests that ask for the same thing, such as `$AA6` and `@AA` of a digital module,
//! share their code.

use super::{Description, channels, decimal};
use crate::{
    AlarmKind, AlarmMode, AnalogIn, AnalogOut, Command, Common, Counter, Digital, Edge, GateMode,
    GroupWrite, InputMode, Stored, UpTo,
};
use std::fmt;

impl Command {
    /// Describes the request without its address.
    pub fn describe(&self) -> Description {
        match *self {
            Self::HostOk => Description::new("host_ok"),
            Self::SampleAll => Description::new("sample_all"),
            Self::Common(_, ask) => common(ask),
            Self::AnalogIn(_, ask) => analog_in(ask),
            Self::AnalogOut(_, ask) => analog_out(ask),
            Self::Digital(_, ask) => digital(ask),
            Self::Counter(_, ask) => counter(ask),
        }
    }
}

impl fmt::Display for Command {
    /// Writes address, code and arguments, as `03 read_input channel=2`, for programs without texts.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.address() {
            Some(address) => write!(f, "{address} {}", self.describe()),
            None => self.describe().fmt(f),
        }
    }
}

fn common(ask: Common) -> Description {
    let one = Description::new;
    match ask {
        Common::ReadConfig => one("read_config"),
        Common::WriteConfig { address, config } => {
            config.describe("write_config", "write_config_checksum", address)
        }
        Common::ReadResetStatus => one("read_restarted"),
        Common::ReadFirmware => one("read_firmware"),
        Common::ReadName => one("read_name"),
        Common::WriteName(name) => one("write_name").with("name", name),
        Common::ReadInitPin => one("read_init_open"),
        Common::ReadWatchdogStatus => one("read_watchdog_status"),
        Common::ClearWatchdogStatus => one("clear_watchdog_status"),
        Common::ReadWatchdog => one("read_watchdog"),
        Common::WriteWatchdog {
            enabled,
            timeout_tenths,
        } => one(match enabled {
            true => "write_watchdog_on",
            false => "write_watchdog_off",
        })
        .with("timeout_s", decimal(timeout_tenths)),
        Common::ReadResponseDelay => one("read_response_delay"),
        Common::WriteResponseDelay { delay_ms } => {
            one("write_response_delay").with("delay_ms", delay_ms)
        }
        Common::ReadProtocol => one("read_modbus"),
        Common::WriteProtocol { modbus: true } => one("write_protocol_modbus"),
        Common::WriteProtocol { modbus: false } => one("write_protocol_dcon"),
        Common::EnterSoftInit => one("enter_soft_init"),
        Common::OpenSoftInit { seconds } => one("open_soft_init").with("seconds", seconds),
    }
}

fn analog_in(ask: AnalogIn) -> Description {
    let one = Description::new;
    match ask {
        AnalogIn::ReadAll(_) => one("read_inputs"),
        AnalogIn::ReadOne { channel, .. } => one("read_input").with("channel", channel),
        AnalogIn::ReadAllHex(_) => one("read_inputs_hex"),
        AnalogIn::ReadMask => one("read_enabled_inputs"),
        AnalogIn::WriteMask(mask) => {
            one("write_enabled_inputs").with("channels", channels(mask.into(), 0))
        }
        AnalogIn::ReadColdJunction => one("read_cold_junction"),
        AnalogIn::ReadDiagnosis => one("read_faulty_inputs"),
        AnalogIn::ReadChannelRange { channel } => one("read_input_range").with("channel", channel),
        AnalogIn::WriteChannelRange { channel, range } => one("write_input_range")
            .with("channel", channel)
            .with("type", range),
    }
}

fn analog_out(ask: AnalogOut) -> Description {
    // A request to a module with one output has no channel number; its description uses output 0.
    let of = |code, channel: Option<_>| {
        let number = channel.map_or(0, UpTo::get);
        Description::new(code).with("output", number)
    };
    match ask {
        AnalogOut::Write { channel, level } => of("write_level", channel).with("level", level),
        AnalogOut::ReadLast { channel, .. } => of("read_last_level", channel),
        AnalogOut::ReadPresent { channel, .. } => of("read_present_level", channel),
        AnalogOut::StorePowerOn { channel } => of("store_power_on_level", channel),
        AnalogOut::ReadPowerOn { channel, .. } => of("read_power_on_level", channel),
        AnalogOut::StoreSafe { channel } => of("store_safe_level", channel),
        AnalogOut::ReadSafe { channel, .. } => of("read_safe_level", channel),
        AnalogOut::ReadChannelConfig { channel } => of("read_output_range", Some(channel)),
        AnalogOut::WriteChannelConfig {
            channel,
            range,
            slew,
        } => {
            let range = crate::analog_out::output_range(range.get());
            let description = match slew.in_units(range) {
                Some(slew) => Description::new("write_output_range").with("slew", slew),
                None => Description::new("write_output_range_immediate"),
            };
            description.with("output", channel).with("type", range)
        }
    }
}

fn digital(ask: Digital) -> Description {
    let one = Description::new;
    match ask {
        Digital::ReadAll | Digital::ReadPort => one("read_digital"),
        Digital::Write(word) => one("write_outputs").with("outputs", channels(word.bits(), 0)),
        Digital::WriteGroup(write) => group(write),
        Digital::ReadEvents { channel } => one("read_events").with("channel", channel),
        Digital::ClearEvents { channel } => one("clear_events").with("channel", channel),
        Digital::ReadLatched { high: true } => one("read_latched_high"),
        Digital::ReadLatched { high: false } => one("read_latched_low"),
        Digital::ClearLatched => one("clear_latched"),
        Digital::ReadSampled => one("read_sampled"),
        Digital::ReadStored(Stored::PowerOn) => one("read_power_on_outputs"),
        Digital::ReadStored(Stored::Safe) => one("read_safe_outputs"),
        Digital::Store(Stored::PowerOn) => one("store_power_on_outputs"),
        Digital::Store(Stored::Safe) => one("store_safe_outputs"),
    }
}

fn group(write: GroupWrite) -> Description {
    let one = |output: u8, on| {
        let code = if on { "output_on" } else { "output_off" };
        Description::new(code).with("output", output)
    };
    let some =
        |code, bits: u8, from| Description::new(code).with("outputs", channels(bits.into(), from));
    match write {
        GroupWrite::GroupA(bits) => some("write_outputs_0_to_7", bits, 0),
        GroupWrite::GroupB(bits) => some("write_outputs_8_to_15", bits, 8),
        GroupWrite::OneOfA { output, on } => one(output.get(), on),
        GroupWrite::OneOfB { output, on } => one(8 + output.get(), on),
    }
}

fn counter(ask: Counter) -> Description {
    let one = Description::new;
    let of = |code, counter: UpTo<1>| Description::new(code).with("counter", counter);
    match ask {
        Counter::Read(n) => of("read_count", n),
        Counter::ReadFrequency(n) => of("read_frequency", n),
        Counter::Reset(n) => of("reset_count", n),
        Counter::ReadOverflow(n) => of("read_overflow", n),
        Counter::ReadRunning(n) => of("read_running", n),
        Counter::Run(n, true) => of("start_counter", n),
        Counter::Run(n, false) => of("stop_counter", n),
        Counter::ReadPreset(n) => of("read_preset", n),
        Counter::WritePreset(n, value) => of("write_preset", n).with("count", value),
        Counter::ReadMaximum(n) => of("read_maximum", n),
        Counter::WriteMaximum(n, value) => of("write_maximum", n).with("count", value),
        Counter::ReadGate => one("read_gate"),
        Counter::WriteGate(GateMode::Low) => one("write_gate_low"),
        Counter::WriteGate(GateMode::High) => one("write_gate_high"),
        Counter::WriteGate(GateMode::None) => one("write_gate_none"),
        Counter::ReadInputs => one("read_counter_inputs"),
        Counter::WriteInputs(InputMode::BothTtl) => one("write_both_ttl"),
        Counter::WriteInputs(InputMode::BothIsolated) => one("write_both_isolated"),
        Counter::WriteInputs(InputMode::Isolated1) => one("write_isolated_1"),
        Counter::WriteInputs(InputMode::Isolated0) => one("write_isolated_0"),
        Counter::ReadFilter => one("read_filter"),
        Counter::WriteFilter(true) => one("filter_on"),
        Counter::WriteFilter(false) => one("filter_off"),
        Counter::ReadFilterWidth(Edge::High) => one("read_width_high"),
        Counter::ReadFilterWidth(Edge::Low) => one("read_width_low"),
        Counter::WriteFilterWidth(Edge::High, us) => one("write_width_high").with("width_us", us),
        Counter::WriteFilterWidth(Edge::Low, us) => one("write_width_low").with("width_us", us),
        Counter::ReadThreshold(Edge::High) => one("read_threshold_high"),
        Counter::ReadThreshold(Edge::Low) => one("read_threshold_low"),
        Counter::WriteThreshold(edge, tenths) => one(match edge {
            Edge::High => "write_threshold_high",
            Edge::Low => "write_threshold_low",
        })
        .with("volts", decimal(tenths.get())),
        Counter::ReadAlarm(AlarmMode::PerCounter) => one("read_alarms_mode_0"),
        Counter::ReadAlarm(AlarmMode::HighHigh) => one("read_alarms_mode_1"),
        Counter::ReadAlarmMode => one("read_alarm_mode"),
        Counter::WriteAlarmMode(AlarmMode::PerCounter) => one("write_alarm_mode_0"),
        Counter::WriteAlarmMode(AlarmMode::HighHigh) => one("write_alarm_mode_1"),
        Counter::EnableAlarm(AlarmKind::Latched) => one("alarm_on_latched"),
        Counter::EnableAlarm(AlarmKind::Momentary) => one("alarm_on_momentary"),
        Counter::DisableAlarm => one("alarm_off"),
        Counter::ClearAlarm => one("clear_alarm"),
        Counter::EnableAlarmOf(n) => of("counter_alarm_on", n),
        Counter::DisableAlarmOf(n) => of("counter_alarm_off", n),
        Counter::ReadLimit(n) => one("read_alarm_limit").with("limit", n),
        Counter::WriteLimit(n, value) => one("write_alarm_limit")
            .with("limit", n)
            .with("count", value),
        Counter::WriteOutputs(bits) => {
            one("write_outputs").with("outputs", channels(bits.get().into(), 0))
        }
        Counter::ReadDisplay => one("read_display"),
        Counter::WriteDisplay(source) => match source.get() {
            n @ 0..=1 => one("display_counter").with("counter", n),
            2.. => one("display_number"),
        },
        Counter::WriteDisplayed(number) => one("write_displayed").with("number", number),
    }
}
