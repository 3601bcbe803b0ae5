//! The guard rejects a bad scene and names the place in the file.

use super::*;

fn flaw_of(change: impl FnOnce(&mut GuardSettings)) -> String {
    let mut settings = scene_settings();
    change(&mut settings);
    Guard::build(&settings).err().unwrap().to_string()
}

#[test]
fn the_scene_of_the_rig_is_accepted() {
    let mut guard = guard();
    assert_eq!(guard.stroke_mm(Actuator::SortAxis), (0.0, 350.0));
    assert!(guard.clear(&Motion::group(&[]), &rest()).is_ok());
}

#[test]
fn errors_of_bad_scenes_name_the_place() {
    type Change = fn(&mut GuardSettings);
    let cases: [(Change, &str); 12] = [
        (
            |s| s.units = Some("inch".into()),
            "units: found \"inch\", expected \"mm\"",
        ),
        (
            |s| s.guard.default_margin_mm = -1.0,
            "guard.default_margin_mm: found -1, expected >= 0",
        ),
        (
            |s| s.guard.nest[2] = f64::NAN,
            "guard.nest[2]: found NaN, expected a finite number",
        ),
        (
            |s| s.elements[0].half = None,
            "elements[0]: a block needs half and no other size",
        ),
        (
            |s| s.elements[0].radius = Some(1.0),
            "elements[0]: a block needs half and no other size",
        ),
        (
            |s| s.elements[0].half = Some([1.0, 0.0, 1.0]),
            "elements[0]: not a body",
        ),
        (
            |s| s.elements[1].id = "baseplate_left_rear".into(),
            "elements[1]: the id \"baseplate_left_rear\" is taken, expected one of its own",
        ),
        (
            |s| drop(s.actuator.pop()),
            "actuator: gripper is described 0 times, expected once",
        ),
        (
            |s| s.actuator[0].axis = [1.0, 1.0, 0.0],
            "actuator escapement.axis: found 1.4142135623730951, expected a length of 1",
        ),
        (
            |s| s.actuator[1].stroke_mm = Some(0.0),
            "actuator pusher.stroke_mm: found 0, expected above 0, or points_mm in its place",
        ),
        (
            |s| s.pair[3].b = "jaws_*".into(),
            "pair[3]: no body is called \"jaws_*\"",
        ),
        (
            |s| s.actuator[5].rides = Some(Actuator::SortZ),
            "actuator sort_axis: rides on itself through others",
        ),
    ];
    for (change, message) in cases {
        assert_eq!(flaw_of(change), message);
    }
}

#[test]
fn a_blocked_stroke_is_found_before_anything_moves() {
    let message = flaw_of(|s| {
        let stop = s.elements.iter_mut().find(|e| e.id == "nest_stop").unwrap();
        stop.pose.position[0] = -20.0;
    });
    assert_eq!(
        message,
        "actuator pusher: its own stroke is not free in an empty rig"
    );
}

#[test]
fn an_actuator_without_words_is_called_by_its_id() {
    let mut settings = scene_settings();
    settings.actuator[Actuator::SortZ.index()].to_rest = None;
    let mut guard = Guard::build(&settings).unwrap();
    let down = rest().with(Actuator::SortZ, at(40.0));
    let no = guard
        .clear(&Motion::to(Actuator::SortAxis, 150.0), &down)
        .unwrap_err();
    assert!(
        no.to_string()
            .ends_with("would help: move sort_z to its rest end"),
        "{no}"
    );
}

#[test]
fn an_unknown_key_is_an_error_with_its_line() {
    let misspelt = SCENE.replacen("touch_depth_mm", "touch_deph_mm", 1);
    let message = toml::from_str::<GuardSettings>(&misspelt)
        .unwrap_err()
        .to_string();
    assert!(message.contains("touch_deph_mm"), "{message}");
}

#[test]
fn the_guard_knows_every_point_of_the_slide() {
    let rig: toml::Table = toml::from_str(include_str!("../../../../../config/rig.toml")).unwrap();
    let settings = scene_settings();
    let points = settings.actuator[Actuator::SortAxis.index()]
        .points_mm
        .as_ref()
        .unwrap();
    let tables = ["axis", "bin"].map(|key| rig[key].as_table().unwrap().values());
    let x_mm = tables
        .into_iter()
        .flatten()
        .map(|point| point["x_mm"].as_float().unwrap());
    let unknown: Vec<f64> = x_mm.filter(|x| !points.contains(x)).collect();
    assert_eq!(unknown, [0.0; 0]);
}

#[test]
fn every_alias_of_an_actuator_parses() {
    for name in Actuator::names().iter().chain(&Actuator::OTHER_NAMES) {
        let text = format!("id = \"{name}\"\naxis = [1.0, 0.0, 0.0]");
        let read: ActuatorSettings = toml::from_str(&text).unwrap();
        assert!(read.id.name() == *name || name.starts_with("clamp_"));
    }
}

#[test]
fn a_quaternion_of_any_length_but_zero_is_taken() {
    let mut settings = scene_settings();
    settings.elements[0].pose.rotation = [1e120, 0.0, 0.0, 0.0];
    settings.elements[1].pose.rotation = [1e-120, 0.0, 0.0, 0.0];
    Guard::build(&settings).unwrap();
    assert_eq!(
        flaw_of(|s| s.elements[0].pose.rotation = [0.0; 4]),
        "elements[0]: not a body"
    );
}
