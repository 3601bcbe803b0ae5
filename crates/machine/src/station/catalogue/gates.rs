//! Alarms of the gates of a lot, and of what wears.

use super::{Entry, GOES_ON, Goes, RESTS, Stops};

pub(super) const GATES: &[Entry] = &[
    Entry {
        code: "golden_check_due",
        stops: Stops::Hold,
        goes: Goes::ByClear,
        retries: 0,
        cause: (
            "The last golden check is longer ago than the lot allows.",
            "距上次标准件检查的时间已超过批次规定。",
        ),
        consequence: RESTS,
        action: (
            "Put the golden part named in front of all others, also of one that waits in the pocket, then unhold.",
            "把所示标准件放到所有工件之前（包括料窝中等待的工件），然后解除保持。",
        ),
    },
    Entry {
        code: "golden_check_failed",
        stops: Stops::Hold,
        goes: Goes::ByClear,
        retries: 0,
        cause: (
            "A golden part does not read as its certificate says: dirty probes, drift, or another part.",
            "标准件测量结果与证书不符：探针脏污、漂移或工件放错。",
        ),
        consequence: (
            "The line rests; parts since the last good check are suspect; nothing but a golden part is judged next.",
            "生产线暂停；自上次合格检查以来的工件为可疑件；下一件只能是标准件。",
        ),
        action: (
            "Clean the probes, put the golden part in front of all others, then unhold; if it fails again, stop and calibrate.",
            "清洁探针，把标准件放到所有工件之前，然后解除保持；若仍未通过，停机并校准。",
        ),
    },
    Entry {
        code: "golden_repeated",
        stops: Stops::Nothing,
        goes: Goes::ByClear,
        retries: 2,
        cause: (
            "The test of a golden part was cut off: a reply was lost or refused, or a reading was none.",
            "标准件的测试中断：应答丢失或被拒绝，或读数无效。",
        ),
        consequence: GOES_ON,
        action: (
            "Nothing; if it comes often, look at the line of the measuring modules.",
            "无需处理；若经常出现，请检查测量模块的通信线路。",
        ),
    },
    Entry {
        code: "lot_discard_limit",
        stops: Stops::Hold,
        goes: Goes::ByClear,
        retries: 0,
        cause: (
            "More parts have failed than the lot may have.",
            "不合格件数超过批次允许值。",
        ),
        consequence: RESTS,
        action: (
            "Decide whether the lot is discarded; unhold goes on with it.",
            "决定批次是否拒收；解除保持则继续。",
        ),
    },
    Entry {
        code: "probe_contact",
        stops: Stops::Nothing,
        goes: Goes::ByClear,
        retries: 0,
        cause: (
            "Less of the supply reaches the coil than at the calibration: dirty or worn probes, or an input that has drifted.",
            "到达线圈的电压低于校准时的数值：探针脏污、磨损，或输入漂移。",
        ),
        consequence: GOES_ON,
        action: (
            "Clean the probes. If it stays, check with a golden part and calibrate.",
            "清洁探针；若仍存在，请用标准件检查并重新校准。",
        ),
    },
    Entry {
        code: "_worn",
        stops: Stops::Nothing,
        goes: Goes::ByClear,
        retries: 0,
        cause: (
            "Probes or jaws were used as often as they last.",
            "探针或夹爪已达到使用寿命。",
        ),
        consequence: GOES_ON,
        action: (
            "Replace them at the next occasion and say so with `relayrig wear replaced`.",
            "择机更换，并用 `relayrig wear replaced` 登记。",
        ),
    },
];
