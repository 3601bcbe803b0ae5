//! Alarms: trouble of the rig, each with what happened and what to do, in English and Chinese.

use super::moves::Move;
use crate::units::Span;
use serde::Serialize;

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
    pub fn not_reached(movement: Move, after: Span) -> Self {
        let key = movement.actuator_key();
        let ms = after.0 / 1000;
        let wanted: Vec<String> = movement
            .arrival()
            .iter()
            .map(|(point, state)| format!("{point}={}", u8::from(*state)))
            .collect();
        Self::new(
            format!("{key}_not_reached"),
            format!(
                "{movement:?} not finished after {ms} ms (expects {}). Check air, sensor and obstacles at the {key}.",
                wanted.join(", ")
            ),
            format!(
                "{key} 动作 {movement:?} 在 {ms} 毫秒内未到位（应为 {}）。请检查气源、传感器和障碍物。",
                wanted.join("，")
            ),
        )
    }

    /// The guard refused a motion.
    pub fn refused(movement: Move, refusal: &str) -> Self {
        Self::new(
            "motion_refused",
            format!("{movement:?} refused: {refusal}"),
            format!("动作 {movement:?} 被防碰撞检查拒绝：{refusal}"),
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

    /// No part came into the pocket.
    pub fn no_part() -> Self {
        Self::new(
            "part_not_arrived",
            "No part came from the magazine into the pocket. Fill the magazine or free the track.",
            "料道没有工件进入料窝。请加料或疏通料道。",
        )
    }

    /// The pusher is at the nest but no part is.
    pub fn nest_empty() -> Self {
        Self::new(
            "part_not_in_nest",
            "The pusher is extended but the nest is empty. Look for a fallen part.",
            "推料缸已伸出但测试位无工件。请查找掉落的工件。",
        )
    }

    /// The beam of a bin saw no part, or more than one.
    pub fn beam(bin: &str, seen: u32) -> Self {
        Self::new(
            "bin_beam",
            format!(
                "The beam of bin {bin} counted {seen} parts where one was let go. Check the bin and the chute."
            ),
            format!("料箱 {bin} 的光电传感器计到 {seen} 个工件，应为 1 个。请检查料箱和滑道。"),
        )
    }

    /// A safety input has opened.
    pub fn safety(code: &str, text_en: &str, text_zh: &str) -> Self {
        Self::new(code, text_en, text_zh)
    }

    /// Parts were found where none may be at the start.
    pub fn not_empty(place: &str) -> Self {
        Self::new(
            "part_found_at_start",
            format!("A part lies in the {place} at the start. Take it out and start again."),
            format!("启动时 {place} 内有工件。请取出后重新启动。"),
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
