//! Alarms: trouble of the rig, each with what happened and what to do, in English and Chinese. Those about parts and the
//! places where parts are expected stand in `parts`.

mod parts;

use super::chinese;
use crate::handling::Move;
use crate::handling::trouble::Trouble;
use crate::rig::point::DigitalIn;
use serde::Serialize;
use units::Span;

/// One alarm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Alarm {
    /// Short name that stays the same over versions: `pusher_not_reached`.
    pub code: String,
    /// What happened and what to do, English.
    pub text_en: String,
    /// The same, Chinese.
    pub text_zh: String,
}

impl From<Trouble> for Alarm {
    fn from(trouble: Trouble) -> Self {
        match trouble {
            Trouble::NotReached(movement, limit) => Self::not_reached(movement, limit),
            Trouble::Retried(movement, limit) => Self::retried(movement, limit),
            Trouble::LeftEnd(movement) => Self::left_end(movement),
            Trouble::BothEnds(movement) => Self::both_ends(movement),
            Trouble::AxisDrive => Self::axis_drive(),
            Trouble::NoPart => Self::no_part(),
            Trouble::MagazineEmpty => Self::magazine_empty(),
            Trouble::NestEmpty => Self::nest_empty(),
            Trouble::Beam(bin, seen) => Self::beam(bin.name(), seen),
            Trouble::Found(place) => Self::part_found(place.name()),
            Trouble::Lost(place) => Self::part_lost(place.name()),
            Trouble::Gone(place) => Self::part_gone(place.name()),
            Trouble::FallUnseen(bin) => Self::fall_unseen(bin.name()),
            Trouble::Dropped => Self::part_dropped(),
            Trouble::Sticks => Self::part_sticks(),
            Trouble::Stuck => Self::part_stuck(),
            Trouble::GoldenRepeated(serial, why) => Self::golden_repeated(&serial, &why),
        }
    }
}

impl Alarm {
    /// An alarm with its texts.
    pub fn new(
        code: impl Into<String>,
        text_en: impl Into<String>,
        text_zh: impl Into<String>,
    ) -> Self {
        Self {
            code: code.into(),
            text_en: text_en.into(),
            text_zh: text_zh.into(),
        }
    }

    /// An actuator did not show the end of its motion in time.
    pub fn not_reached(movement: Move, limit: Span) -> Self {
        let key = movement.actuator_key();
        let ms = limit.0 / 1000;
        let wanted: Vec<String> = movement
            .arrival()
            .iter()
            .map(|(point, state)| format!("{point}={}", u8::from(*state)))
            .collect();
        Self::new(
            format!("{key}_not_reached"),
            format!(
                "{movement:?} not finished within {ms} ms (expects {}). Check air, sensor and obstacles at the {key}.",
                wanted.join(", ")
            ),
            format!(
                "{}在 {ms} 毫秒内未到位（应为 {}）。请检查气源、传感器和障碍物。",
                chinese::motion(movement),
                wanted.join("，")
            ),
        )
    }

    /// The guard refused a motion.
    pub fn refused(movement: Move, refusal: &str) -> Self {
        Self::new(
            "motion_refused",
            format!("{movement:?} refused: {refusal}"),
            format!("{}被防碰撞检查拒绝：{refusal}", chinese::motion(movement)),
        )
    }

    /// A line or a module does not answer as it should.
    pub fn bus(text: &str) -> Self {
        Self::new(
            "bus_trouble",
            format!("{text}. Check cable, power and address of the module."),
            format!("总线故障：{text}。请检查电缆、电源和模块地址。"),
        )
    }

    /// The history cannot be written, so no part may go on.
    pub fn history() -> Self {
        Self::new(
            "history_lost",
            "The history file cannot be written. Check the disk and who holds the file, then start again.",
            "无法写入历史数据库。请检查磁盘以及文件是否被占用，然后重新启动。",
        )
    }

    /// Some output did not confirm its safe value.
    pub fn not_safe() -> Self {
        Self::new(
            "outputs_not_confirmed",
            "Not every output has confirmed its safe value. The modules' own watchdogs make them safe; check the lines.",
            "并非所有输出都确认了安全值。模块自身的看门狗会使其安全；请检查通信线路。",
        )
    }

    /// A safety input is not read any more.
    pub fn stale(point: DigitalIn) -> Self {
        Self::new(
            "sensor_stale",
            format!(
                "{point} was not read for too long. Check cable, power and address of its module."
            ),
            format!("{point} 长时间未读到。请检查电缆、电源和模块地址。"),
        )
    }

    /// A safety input has opened.
    pub fn safety(code: &str, text_en: &str, text_zh: &str) -> Self {
        Self::new(code, text_en, text_zh)
    }

    /// A push button stays down.
    pub fn button_stuck(button: DigitalIn) -> Self {
        let name = button.name();
        Self::new(
            "button_stuck",
            format!("{name} stays down. Let it go, or free it; it orders nothing until then."),
            format!("按钮 {name} 一直处于按下状态。请松开或检修；松开前该按钮无效。"),
        )
    }

    /// A stroke did not arrive and is tried once more.
    pub fn retried(movement: Move, limit: Span) -> Self {
        let key = movement.actuator_key();
        let ms = limit.0 / 1000;
        Self::new(
            format!("{key}_retried"),
            format!("{movement:?} not finished within {ms} ms; it goes back and tries once more."),
            format!(
                "{}在 {ms} 毫秒内未到位；退回后重试一次。",
                chinese::motion(movement)
            ),
        )
    }

    /// An actuator left its end by itself.
    pub fn left_end(movement: Move) -> Self {
        let key = movement.actuator_key();
        Self::new(
            format!("{key}_left_end"),
            format!(
                "The {key} left the end of {movement:?} although nothing moves it. Check air, hoses and sensor."
            ),
            format!(
                "{}在未动作时离开“{}”的端位。请检查气源、气管和传感器。",
                chinese::name(key),
                chinese::motion(movement)
            ),
        )
    }

    /// Both ends of an actuator are seen at once.
    pub fn both_ends(movement: Move) -> Self {
        let key = movement.actuator_key();
        Self::new(
            format!("{key}_both_ends"),
            format!("The {key} shows both ends at once (after {movement:?}). One sensor is stuck."),
            format!(
                "{}两端传感器同时有信号（“{}”之后）。其中一个传感器卡住。",
                chinese::name(key),
                chinese::motion(movement)
            ),
        )
    }

    /// The drive of the sort axis has tripped.
    pub fn axis_drive() -> Self {
        Self::new(
            "axis_drive",
            "The drive of the sort axis reports an alarm. Look for an obstacle; clear and reset switch it on again.",
            "分拣轴驱动器报警。请检查障碍物；清除并复位后重新使能。",
        )
    }

    /// A step waits for longer than it can need.
    pub fn step_too_long(what: &str, after: Span) -> Self {
        let s = after.as_seconds();
        Self::new(
            "step_too_long",
            format!("{what} has been waiting for {s:.0} s. Look at sensors and parts there."),
            format!("步骤 {what} 已等待 {s:.0} 秒。请检查该处的传感器和工件。"),
        )
    }

    /// Modules had made themselves safe because their host was silent.
    pub fn watchdog_tripped(module: &str) -> Self {
        Self::new(
            "watchdog_tripped",
            format!(
                "{module} had made its outputs safe because the controller was silent. It is ready again."
            ),
            format!("{module} 曾因控制器无应答而转入安全输出，现已恢复。"),
        )
    }

    /// The probes lose more on the way to the coil than they may, mean over the last parts.
    pub fn probe_contact(mean_ohm: f64, limit_ohm: f64) -> Self {
        Self::new(
            "probe_contact",
            format!(
                "The probes of the coil have {mean_ohm:.2} ohm in series, mean over the last parts; the limit is {limit_ohm:.2} ohm. Clean them."
            ),
            format!(
                "线圈探针串联接触电阻(近期工件均值)为 {mean_ohm:.2} Ω，限值 {limit_ohm:.2} Ω。请清洁探针。"
            ),
        )
    }

    /// A golden part has to be measured, and nobody can have put it into the magazine.
    pub fn golden_check_due(serial: &str) -> Self {
        Self::new(
            "golden_check_due",
            format!(
                "A golden check is due. Put golden part {serial} in front of all others, then unhold."
            ),
            format!("需要用标准件检查。请把标准件 {serial} 放到所有工件之前，然后解除保持。"),
        )
    }

    /// A golden part does not read as certified.
    pub fn golden_check_failed(why: &str) -> Self {
        Self::new(
            "golden_check_failed",
            format!("Golden check failed: {why}. Parts since the last good check are suspect."),
            format!("标准件检查未通过：{why}。自上次合格检查以来的工件均为可疑件。"),
        )
    }

    /// More parts have failed than the lot may have.
    pub fn discard_limit(failed: u64, judged: u64, limit_pct: f64) -> Self {
        Self::new(
            "lot_discard_limit",
            format!("{failed} of {judged} parts failed, more than {limit_pct} % of the lot."),
            format!("{judged} 件中有 {failed} 件不合格，超过批次的 {limit_pct} %。"),
        )
    }

    /// Something was used as often as it lasts.
    pub fn worn(what: &str, count: u64, limit: u64) -> Self {
        Self::new(
            format!("{what}_worn"),
            format!("The {what} were used {count} times, the limit is {limit}. Replace them."),
            format!("{what} 已使用 {count} 次，寿命上限为 {limit} 次。请更换。"),
        )
    }

    /// The calibration may not be used any more.
    pub fn calibration_overdue() -> Self {
        Self::new(
            "calibration_overdue",
            "The calibration has run out. The next start makes a new one from the golden parts.",
            "校准已过期。下次启动时将用标准件重新校准。",
        )
    }

    /// A calibration before this start was cut off and left a channel mask of its own.
    pub fn calibration_cut_off(module: &str) -> Self {
        Self::new(
            "calibration_cut_off",
            format!(
                "{module} still had the channel mask of the references: a calibration was cut off. The mask of the lots is back."
            ),
            format!("{module} 仍为标准器测量的通道掩码：上次校准被中断。现已恢复生产掩码。"),
        )
    }

    /// The test of a golden part was cut off and begins anew.
    pub fn golden_repeated(serial: &str, why: &str) -> Self {
        Self::new(
            "golden_repeated",
            format!("Golden part {serial} is tested again: {why}."),
            format!("标准件 {serial} 重新测试：{why}。"),
        )
    }

    /// Calibration did not come out.
    pub fn calibration(text: &str) -> Self {
        Self::new(
            "calibration_failed",
            format!("Calibration failed: {text}"),
            format!("校准失败：{text}"),
        )
    }
}
