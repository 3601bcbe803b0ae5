//! Names of places, bins, motions and steps in Chinese, for texts of alarms; the words are those of the screen.

use crate::handling::Move;
use crate::rig::axis::AxisStation;

/// A place of the ledger, a bin, an actuator or a step; anything else, a module of the plant say, keeps its name.
pub fn name(of: &str) -> &str {
    match of {
        "pocket" => "料窝",
        "nest" => "测试位",
        "gripper" => "夹爪",
        "escapement" => "擒纵",
        "pusher" => "推料",
        "clamp" => "夹紧",
        "probe_lift" => "探针升降",
        "sort_z" => "分选升降",
        "axis" => "分选轴",
        other => bin(other),
    }
}

/// A bin by its name; one that a plant has named itself keeps that.
pub fn bin(name: &str) -> &str {
    match name {
        "pass" => "合格",
        "coil" => "线圈",
        "contact" => "触点",
        "voltage" => "电压",
        "time" => "时间",
        "retest" => "复测",
        other => other,
    }
}

/// A motion.
pub fn motion(it: Move) -> String {
    let fixed = match it {
        Move::EscapementRelease => "擒纵放料",
        Move::EscapementHold => "擒纵挡料",
        Move::PusherExtend => "推料伸出",
        Move::PusherRetract => "推料缩回",
        Move::ClampClose => "夹紧",
        Move::ClampOpen => "松开",
        Move::ProbesUp => "探针上升",
        Move::ProbesDown => "探针下降",
        Move::SortDown => "分选下降",
        Move::SortUp => "分选上升",
        Move::GripperClose => "夹爪合",
        Move::GripperOpen => "夹爪开",
        Move::AxisTo(AxisStation::Nest) => "分选轴到测试位",
        Move::AxisTo(AxisStation::Park) => "分选轴到停放位",
        Move::AxisTo(AxisStation::Bin(to)) => return format!("分选轴到{}箱", bin(to.name())),
    };
    fixed.to_owned()
}
