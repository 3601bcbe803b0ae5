//! Tests of the inputs that strokes need, as `[actuator]` of `rig.toml` declares them.

use super::plant::Copy;
use crate::{Folder, Plant};
use std::path::Path;

/// Makes a copy of the default rig in which a stroke of an actuator needs an input.
fn with(actuator: &str, limit_ms: u32, needs: &str) -> Copy {
    let from = format!("{actuator} = {{ timeout_ms = {limit_ms} }}");
    let to = format!("{actuator} = {{ timeout_ms = {limit_ms}, {needs} }}");
    Copy::with("rig.toml", |rig| {
        let mut lines: Vec<String> = rig.lines().map(str::to_owned).collect();
        let squeezed = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        let own = lines.iter_mut().find(|line| squeezed(line) == from);
        own.unwrap().clone_from(&to);
        lines.join("\n")
    })
}

#[test]
fn only_declared_strokes_need_an_input() {
    let inputs = |folder: &Folder| -> Vec<String> {
        let guarded = Plant::load(folder).unwrap().wiring.guarded();
        guarded.into_iter().map(|it| it.input).collect()
    };
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config");
    assert!(inputs(&Folder::from(config.as_path())).is_empty());
    let ssr = Folder::from(config.join("rigs/ssr").as_path());
    assert_eq!(inputs(&ssr), ["output_safe", "output_safe"]);
    let own = with("gripper", 600, "to_end_needs = \"window\"");
    assert_eq!(inputs(&own.0.path().into()), ["window"]);
}

#[test]
fn a_stroke_cannot_need_an_unknown_input() {
    for (actuator, limit_ms, needs, message) in [
        (
            "clamp",
            800,
            "to_rest_needs = \"socket_dead\"",
            "[actuator].clamp.to_rest_needs: found \"socket_dead\", expected an input of [digital_in]",
        ),
        (
            "axis",
            3000,
            "to_end_needs = \"door_closed\"",
            "[actuator].axis.to_end_needs: found \"door_closed\", expected nothing, because the axis stops at many places",
        ),
    ] {
        let found = with(actuator, limit_ms, needs).refused();
        let (_, found) = found.split_once(": ").unwrap();
        assert_eq!(found, message);
    }
}
