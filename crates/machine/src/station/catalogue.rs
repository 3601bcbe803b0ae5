//! Every alarm of the station: why it happens, what follows, what to do, in English and Chinese; what it
//! stops, what clears it and how often the station tries again by itself.
//!
//! A code that names an actuator (`pusher_not_reached`) is listed by its ending. A code that is not here
//! cannot be raised: `every_alarm_that_the_station_can_raise_is_in_the_catalogue`.

mod gates;

/// What an alarm stops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stops {
    /// Outputs go safe at once.
    Abort,
    /// The sequence rests at its next point and waits for a person.
    Hold,
    /// The sequence rests and goes on by itself when the cause outside has gone.
    Suspend,
    /// Nothing; it is told.
    Nothing,
}

/// What makes the cause count as gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goes {
    /// The sensor says so.
    BySensor,
    /// A person has looked and says so with `clear` or `unhold`.
    ByClear,
    /// It is told once and gone at once.
    AtOnce,
}

/// One entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Code, or the ending of codes that name an actuator.
    pub code: &'static str,
    /// What it stops.
    pub stops: Stops,
    /// What clears it.
    pub goes: Goes,
    /// Tries again by itself, per part.
    pub retries: u8,
    /// Why it happens.
    pub cause: (&'static str, &'static str),
    /// What follows from it.
    pub consequence: (&'static str, &'static str),
    /// What to do.
    pub action: (&'static str, &'static str),
}

const SAFE: (&str, &str) = (
    "All outputs are safe; a part inside goes to retest after the reset.",
    "所有输出已安全；复位后机内工件送入复测箱。",
);
const RESTS: (&str, &str) = (
    "The line rests at its next point; parts inside stay where they are.",
    "生产线在下一个停点暂停；机内工件保持原位。",
);
const WAITS: (&str, &str) = (
    "The line waits and goes on by itself.",
    "生产线等待，条件恢复后自动继续。",
);
const GOES_ON: (&str, &str) = ("The line goes on.", "生产线继续运行。");

const fn abort(
    code: &'static str,
    goes: Goes,
    retries: u8,
    cause: (&'static str, &'static str),
    action: (&'static str, &'static str),
) -> Entry {
    Entry {
        code,
        stops: Stops::Abort,
        goes,
        retries,
        cause,
        consequence: SAFE,
        action,
    }
}

/// Alarms of the machine.
const MACHINE: &[Entry] = &[
    abort(
        "emergency_stop",
        Goes::BySensor,
        0,
        ("The emergency-stop chain is open.", "急停回路断开。"),
        (
            "Remove the danger, release the button, then clear and reset.",
            "排除危险，旋开急停按钮，然后清除并复位。",
        ),
    ),
    abort(
        "door_open",
        Goes::BySensor,
        0,
        ("The door was opened.", "安全门被打开。"),
        (
            "Close the door, then clear and reset.",
            "关好安全门，然后清除并复位。",
        ),
    ),
    abort(
        "air_lost",
        Goes::BySensor,
        0,
        (
            "Air pressure is below the switch point.",
            "气压低于设定值。",
        ),
        (
            "Restore the air supply, then clear and reset.",
            "恢复供气，然后清除并复位。",
        ),
    ),
    abort(
        "_not_reached",
        Goes::ByClear,
        1,
        (
            "An actuator did not show the end of its stroke in time: no air, an obstacle, or a sensor out of place.",
            "执行机构未按时到位：无气、有障碍物或传感器移位。",
        ),
        (
            "Look at the actuator and its end sensors, free it, then clear and reset.",
            "检查该执行机构及其到位传感器，排除卡滞，然后清除并复位。",
        ),
    ),
    abort(
        "_left_end",
        Goes::ByClear,
        0,
        (
            "An actuator left its end although nothing moved it: air too low, a leak, or a loose sensor.",
            "执行机构在未动作时离开端位：气压低、漏气或传感器松动。",
        ),
        (
            "Check hoses and the sensor bracket, then clear and reset.",
            "检查气管和传感器支架，然后清除并复位。",
        ),
    ),
    abort(
        "_both_ends",
        Goes::ByClear,
        0,
        (
            "Both end sensors of an actuator are on at once: one is stuck or shorted.",
            "同一执行机构两端传感器同时有信号：其中一个卡住或短路。",
        ),
        (
            "Replace or realign the sensor that is on without reason, then clear and reset.",
            "更换或校正误动作的传感器，然后清除并复位。",
        ),
    ),
    abort(
        "motion_refused",
        Goes::ByClear,
        0,
        (
            "The collision guard found that a motion would touch something.",
            "防碰撞检查发现动作会发生接触。",
        ),
        (
            "Read who is in the way, free it, then clear and reset.",
            "查看阻挡物并移开，然后清除并复位。",
        ),
    ),
    abort(
        "bus_trouble",
        Goes::ByClear,
        0,
        (
            "A line or module does not answer, or has restarted.",
            "通信线路或模块无应答，或模块已重启。",
        ),
        (
            "Check cable, power and address of the module named, then clear and reset.",
            "检查所示模块的电缆、电源和地址，然后清除并复位。",
        ),
    ),
    abort(
        "sensor_stale",
        Goes::BySensor,
        0,
        (
            "A safety input is not read any more.",
            "安全输入长时间未读到。",
        ),
        (
            "Check cable, power and address of its module; clear and reset once it answers.",
            "检查电缆、电源和模块地址；恢复后清除并复位。",
        ),
    ),
    abort(
        "outputs_not_confirmed",
        Goes::ByClear,
        0,
        (
            "A module has not confirmed its safe outputs.",
            "模块未确认安全输出。",
        ),
        (
            "Its own watchdog makes it safe; check the line, then clear and reset.",
            "模块看门狗会使其安全；检查线路，然后清除并复位。",
        ),
    ),
    abort(
        "history_lost",
        Goes::ByClear,
        0,
        (
            "The history file cannot be written.",
            "无法写入历史数据库。",
        ),
        (
            "Check the disk, then start the program again.",
            "检查磁盘，然后重新启动程序。",
        ),
    ),
    abort(
        "calibration_failed",
        Goes::ByClear,
        0,
        (
            "References or golden parts do not agree with their certificates.",
            "标准器或标准件与证书不符。",
        ),
        (
            "Check the golden parts and their order, put them at the head of the magazine, then clear, reset and start.",
            "检查标准件及其顺序，放到料道最前端，然后清除、复位并启动。",
        ),
    ),
    abort(
        "calibration_overdue",
        Goes::ByClear,
        0,
        (
            "The calibration has run out during the lot.",
            "校准在批次进行中已过期。",
        ),
        (
            "Put the golden parts at the head of the magazine, then clear, reset and start: the start calibrates.",
            "把标准件放到料道最前端，然后清除、复位并启动：启动时自动校准。",
        ),
    ),
    abort(
        "part_not_in_nest",
        Goes::ByClear,
        0,
        (
            "The pusher is extended but no part is in the nest.",
            "推料缸已伸出但测试位无工件。",
        ),
        (
            "Look for a fallen part, then clear and reset.",
            "查找掉落的工件，然后清除并复位。",
        ),
    ),
    abort(
        "part_stuck",
        Goes::ByClear,
        0,
        (
            "A part stayed in the nest or in the fingers.",
            "工件卡在测试位或夹爪中。",
        ),
        (
            "Free the part, then clear and reset.",
            "取下工件，然后清除并复位。",
        ),
    ),
    abort(
        "part_dropped",
        Goes::ByClear,
        0,
        (
            "The gripper lost its part on the way.",
            "夹爪在途中掉落工件。",
        ),
        (
            "Find the part and scrap it, then clear and reset.",
            "找到该工件并报废，然后清除并复位。",
        ),
    ),
    abort(
        "axis_drive",
        Goes::ByClear,
        0,
        (
            "The drive of the sort axis has tripped: an obstacle, overload, or a supply that sags.",
            "分拣轴驱动器跳闸：有障碍物、过载或供电不足。",
        ),
        (
            "Free the slide, then clear and reset; the reset switches the drive on again.",
            "排除滑台障碍，然后清除并复位；复位时驱动器重新使能。",
        ),
    ),
    abort(
        "step_too_long",
        Goes::ByClear,
        0,
        (
            "A step of the sequence waits for something that does not come.",
            "某一步骤长时间等不到条件。",
        ),
        (
            "Read what it waits for, then clear and reset.",
            "查看所等待的条件，然后清除并复位。",
        ),
    ),
    Entry {
        code: "bin_beam",
        stops: Stops::Hold,
        goes: Goes::ByClear,
        retries: 0,
        cause: (
            "The beam of a bin counted no part, or more than one, where one was let go.",
            "料箱光电传感器计数与放下的工件数不符。",
        ),
        consequence: RESTS,
        action: (
            "Look into chute and bin, then acknowledge and unhold.",
            "检查滑道和料箱，确认后解除保持。",
        ),
    },
    Entry {
        code: "part_not_arrived",
        stops: Stops::Hold,
        goes: Goes::ByClear,
        retries: 2,
        cause: (
            "Parts wait in the track but none came into the pocket.",
            "料道有工件但未进入料窝。",
        ),
        consequence: RESTS,
        action: (
            "Free the track, then acknowledge and unhold.",
            "疏通料道，确认后解除保持。",
        ),
    },
    Entry {
        code: "magazine_empty",
        stops: Stops::Suspend,
        goes: Goes::BySensor,
        retries: 2,
        cause: ("The track is empty.", "料道已空。"),
        consequence: WAITS,
        action: ("Fill the magazine.", "请加料。"),
    },
    Entry {
        code: "bin_full",
        stops: Stops::Suspend,
        goes: Goes::BySensor,
        retries: 0,
        cause: (
            "The beam of a bin stays dark: parts stand in the chute.",
            "料箱光电长时间被遮挡：滑道中有工件堆积。",
        ),
        consequence: WAITS,
        action: ("Empty the bin.", "请清空料箱。"),
    },
    Entry {
        code: "_retried",
        stops: Stops::Nothing,
        goes: Goes::AtOnce,
        retries: 0,
        cause: (
            "A stroke did not reach its end and was tried again.",
            "动作未到位，已重试。",
        ),
        consequence: GOES_ON,
        action: (
            "Look at the actuator at the next occasion when it happens often.",
            "若频繁发生，请择机检查该执行机构。",
        ),
    },
    Entry {
        code: "button_stuck",
        stops: Stops::Nothing,
        goes: Goes::BySensor,
        retries: 0,
        cause: (
            "A push button is held, jammed, or its contact is welded.",
            "按钮被按住、卡滞或触点熔焊。",
        ),
        consequence: GOES_ON,
        action: (
            "Free the button or replace its contact.",
            "松开按钮或更换触点。",
        ),
    },
    Entry {
        code: "watchdog_tripped",
        stops: Stops::Nothing,
        goes: Goes::AtOnce,
        retries: 0,
        cause: (
            "The controller was silent for longer than the host watchdog allows: killed, cut off, or too slow.",
            "控制器无应答时间超过看门狗设定：程序被终止、断线或过慢。",
        ),
        consequence: (
            "The module had made its outputs safe; it was switched on again while nothing moved.",
            "模块曾转入安全输出；已在静止状态下恢复。",
        ),
        action: (
            "Find out why the controller was silent.",
            "查明控制器无应答的原因。",
        ),
    },
    Entry {
        code: "calibration_cut_off",
        stops: Stops::Nothing,
        goes: Goes::AtOnce,
        retries: 0,
        cause: (
            "The controller was killed, or the line stopped, while the references were measured.",
            "测量标准器期间程序被终止或生产线停止。",
        ),
        consequence: (
            "The converter had the channel mask of the references; that of the lots was written back.",
            "转换模块曾处于标准器通道掩码；现已写回生产掩码。",
        ),
        action: (
            "None; the calibration is made again when none is valid.",
            "无需操作；若无有效校准将重新校准。",
        ),
    },
    Entry {
        code: "part_lost",
        stops: Stops::Nothing,
        goes: Goes::AtOnce,
        retries: 0,
        cause: (
            "A part that was inside is not seen anywhere after the reset.",
            "复位后未在任何位置检测到原机内工件。",
        ),
        consequence: ("The part is declared lost.", "该工件按丢失处理。"),
        action: ("Find the part and scrap it.", "找到该工件并报废。"),
    },
    Entry {
        code: "fall_unseen",
        stops: Stops::Nothing,
        goes: Goes::AtOnce,
        retries: 0,
        cause: (
            "The program stopped while a part fell.",
            "工件下落时程序终止。",
        ),
        consequence: (
            "Its row names no bin that has seen it.",
            "其记录中没有料箱确认。",
        ),
        action: ("Look into chute and bin.", "检查滑道和料箱。"),
    },
    Entry {
        code: "part_found",
        stops: Stops::Nothing,
        goes: Goes::AtOnce,
        retries: 0,
        cause: (
            "A part nobody knows was found inside.",
            "发现来历不明的工件。",
        ),
        consequence: (
            "It goes to retest, its row says interrupted.",
            "该工件送入复测箱，记录注明中断。",
        ),
        action: (
            "Test it again with the retest parts.",
            "与复测工件一起重新测试。",
        ),
    },
];

/// Every entry.
pub fn every() -> impl Iterator<Item = &'static Entry> {
    MACHINE.iter().chain(gates::GATES)
}

/// Alarms after which nothing is measured before a new calibration.
pub const NEEDS_CALIBRATION: [&str; 2] = ["calibration_failed", "calibration_overdue"];

/// Alarms of which each is about another body: told anew even while the one before it stands.
pub const ABOUT_A_BODY: [&str; 1] = ["bin_beam"];

/// The entry of a code; codes that name an actuator are found by their ending.
pub fn entry(code: &str) -> Option<&'static Entry> {
    every().find(|entry| match entry.code.strip_prefix('_') {
        Some(_) => code.ends_with(entry.code),
        None => entry.code == code,
    })
}
