//! Alarms about parts: not there, not alone, not known, not where they were let go.

use super::super::chinese;
use super::Alarm;

impl Alarm {
    /// No part came into the pocket.
    pub fn no_part() -> Self {
        Self::new(
            "part_not_arrived",
            "No part came from the magazine into the pocket although parts wait in the track. Free the track.",
            "料道有工件但未进入料窝。请疏通料道。",
        )
    }

    /// The track is empty.
    pub fn magazine_empty() -> Self {
        Self::new(
            "magazine_empty",
            "The magazine is empty. Fill it; the line goes on by itself.",
            "料道已空。请加料；生产线自动继续。",
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
        let (more_en, more_zh) = if seen > 1 {
            (
                " What came with it was never tested: take it out.",
                "随之落下的工件未经测试，请取出。",
            )
        } else {
            ("", "")
        };
        Self::new(
            "bin_beam",
            format!(
                "The beam of bin {bin} counted {seen} parts where one was let go.{more_en} Check the bin and the chute."
            ),
            format!(
                "{}箱的光电传感器计到 {seen} 个工件，应为 1 个。{more_zh}请检查料箱和滑道。",
                chinese::bin(bin)
            ),
        )
    }

    /// The run ended before the beam of a bin had seen the part that was let go over it.
    pub fn beam_unread(bin: &str) -> Self {
        Self::new(
            "bin_beam",
            format!(
                "The run ended before the beam of bin {bin} had confirmed the part let go over it. Look whether it is there."
            ),
            format!(
                "运行结束时，{}箱的光电传感器尚未确认放下的工件。请检查工件是否在料箱内。",
                chinese::bin(bin)
            ),
        )
    }

    /// A part that nobody knows lies where the machine looks for one.
    pub fn part_found(place: &str) -> Self {
        Self::new(
            "part_found",
            format!(
                "A part lies in the {place} that does not belong to this run. It goes to retest."
            ),
            format!(
                "{}内有不属于本次运行的工件，将送入复测箱。",
                chinese::name(place)
            ),
        )
    }

    /// A part that was inside is nowhere.
    pub fn part_lost(place: &str) -> Self {
        Self::new(
            "part_lost",
            format!("The part of the {place} is not there any more. Find it and scrap it."),
            format!("{}的工件已不在原位。请找到并报废。", chinese::name(place)),
        )
    }

    /// A run before left a part inside, and it is nowhere.
    pub fn part_gone(place: &str) -> Self {
        Self::new(
            "part_lost",
            format!(
                "A part was last known in the {place} before the program stopped, and is seen nowhere. Look for it, in the bins too, and scrap it."
            ),
            format!(
                "{}在程序终止前有工件，现未在任何位置检测到。请查找（包括料箱）并报废。",
                chinese::name(place)
            ),
        )
    }

    /// A run before let a part go, and was cut off before a beam had confirmed it.
    pub fn fall_unseen(bin: &str) -> Self {
        Self::new(
            "fall_unseen",
            format!(
                "The program stopped before the beam of bin {bin} had confirmed the part let go over it. Look whether it is there."
            ),
            format!(
                "{}箱的光电传感器确认放下的工件之前程序已终止。请检查工件是否在料箱内。",
                chinese::bin(bin)
            ),
        )
    }

    /// The fingers hold nothing any more.
    pub fn part_dropped() -> Self {
        Self::new(
            "part_dropped",
            "The gripper lost its part on the way. Find the part and scrap it.",
            "夹爪在途中掉落工件。请找到该工件并报废。",
        )
    }

    /// The nest still shows the part that the gripper was to take.
    pub fn part_stuck() -> Self {
        Self::new(
            "part_stuck",
            "The gripper was to take the part, but it is still in the nest. Free the part.",
            "夹爪应已取走工件，但测试位仍有工件。请松开工件。",
        )
    }

    /// Open fingers that still hold a part.
    pub fn part_sticks() -> Self {
        Self::new(
            "part_stuck",
            "The fingers are open but a part is still between them. Take it out.",
            "夹爪已张开但仍有工件。请取出工件。",
        )
    }

    /// The beam of a bin stays dark.
    pub fn bin_full(bin: &str) -> Self {
        Self::new(
            "bin_full",
            format!("The beam of bin {bin} stays dark. Empty the bin; the line goes on by itself."),
            format!(
                "{}箱的光电长时间被遮挡。请清空料箱；生产线自动继续。",
                chinese::bin(bin)
            ),
        )
    }
}
