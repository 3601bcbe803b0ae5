//! Tests of scene files.
#![allow(clippy::unwrap_used)]
use super::*;
use crate::pose::Frame;

fn scene(text: &str) -> Result<Scene, SceneError> {
    read_scene(text, Format::Json, &mut |_| {
        Err(MeshFault::File("no files here".into()))
    })
}

fn complaint(text: &str) -> String {
    scene(text).unwrap_err().to_string()
}

const PIN: &str = r#"{"elements":[{"id":"pin","kind":"cylinder","radius":4,"height":30}],"movers":[{"id":"jaw","kind":"block","half":[1,2,3]}]}"#;

#[test]
fn toml_and_json_give_the_same_scene() {
    let toml = "units = \"mm\"\n[[elements]]\nid = \"pin\"\nkind = \"cylinder\"\nradius = 4\nheight = 30.0\n[[movers]]\nid = \"jaw\"\nkind = \"block\"\nhalf = [1, 2, 3]\n";
    let read = read_scene(toml, Format::Toml, &mut |_| {
        Err(MeshFault::File(String::new()))
    })
    .unwrap();
    assert_eq!(read, scene(PIN).unwrap());
}

#[test]
fn every_bad_field_is_named_by_its_path() {
    let block = |half: &str| {
        complaint(&format!(
            r#"{{"elements":[{{"id":"b","kind":"block","half":{half}}}]}}"#
        ))
    };
    assert!(block("[1,-2,3]").starts_with("elements[0].half[1]: found -2, expected"));
    assert!(
        block("[1,NaN,3]").starts_with("elements[0].half[1]: found NaN, expected a finite number")
    );
    assert!(block("[1,1e999,3]").starts_with("elements[0].half[1]: found 1e999"));
    assert!(block("[1,-Infinity,3]").starts_with("elements[0].half[1]: found -Infinity"));
    assert!(block("[1,2]").starts_with("elements[0].half: found a list of 2"));
    assert!(block("[1,2,\"3\"]").starts_with("elements[0].half[2]: found \"3\""));
    assert!(complaint(r#"{"units":"inch"}"#).starts_with("units: found \"inch\", expected \"mm\""));
    assert!(complaint(r#"{"element":[]}"#).starts_with("element: found an unknown key"));
    let part = r#"{"movers":[{"id":"m","kind":"compound","parts":[{"kind":"block","half":[1,1,1]},{"kind":"cylinder","radius":0,"height":1}]}]}"#;
    assert!(complaint(part).starts_with("movers[0].parts[1].radius: found 0"));
    let still =
        r#"{"elements":[{"id":"b","kind":"block","half":[1,1,1],"pose":{"rotation":[0,0,0,0]}}]}"#;
    assert!(complaint(still).starts_with("elements[0].pose.rotation: found [0.0, 0.0, 0.0, 0.0]"));
    let twice = r#"{"elements":[{"id":"b","kind":"block","half":[1,1,1]},{"id":"b","kind":"block","half":[1,1,1]}]}"#;
    assert!(complaint(twice).starts_with("elements[1].id: found \"b\" again"));
}

#[test]
fn a_mesh_is_inline_or_in_a_file() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1 2/2 3/3 -1\n";
    let text = r#"{"elements":[{"id":"m","kind":"mesh","file":"a.OBJ","scale":2.0}]}"#;
    let read = read_scene(text, Format::Json, &mut |_| Ok(obj.as_bytes().to_vec())).unwrap();
    let Shape::Mesh(mesh) = &read.elements[0].shape else {
        panic!("no mesh")
    };
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.vertices[2], [2.0, 2.0, 0.0]);
    let index =
        r#"{"elements":[{"id":"m","kind":"mesh","vertices":[[0,0,0]],"triangles":[[0,0,1]]}]}"#;
    assert!(
        complaint(index)
            .starts_with("elements[0].triangles[0][2]: found 1, expected an index below")
    );
}

#[test]
fn an_error_in_a_move_names_its_line() {
    let scene = scene(PIN).unwrap();
    let wrong = |text: &str| read_moves(text, &scene).unwrap_err().to_string();
    let good = r#"{"id":"a","mover":"jaw","from":{},"to":{"position":[1,0,0]},"ignore":["pin"]}"#;
    let read = read_moves(&format!("{good}\n\n"), &scene).unwrap();
    assert_eq!(
        (read.len(), read[0].margin_mm, read[0].ignore.as_slice()),
        (1, 0.0, &[0][..])
    );
    assert!(wrong(&format!("{good}\n{good}")).starts_with("line 2: id: found \"a\" again"));
    assert!(
        wrong(&good.replace("\"jaw\"", "\"claw\""))
            .starts_with("line 1: mover: found \"claw\", expected the id of a mover")
    );
    assert!(
        wrong(&good.replace("[1,0,0]", "[1,2e6,0]"))
            .starts_with("line 1: to.position[1]: found 2000000")
    );
    assert!(wrong("{").starts_with("line 1: not readable"));
}

/// A valid scene with all parts that only the rig needs.
const FOR_THE_RIG: &str = r#"{"units":"mm",
    "elements":[{"id":"pin","kind":"cylinder","radius":4,"height":30,"rides":"slide"},
                {"id":"finger","kind":"block","half":[1,1,1],"rides":"slide"}],
    "movers":[{"id":"jaw","kind":"block","half":[1,2,3]}],
    "actuator":[{"id":"lift","axis":[0,0,1],"stroke_mm":12},
                {"id":"slide","axis":[1,0,0],"points_mm":[0,75],"rides":"lift","opposed":["finger"]}],
    "pair":[{"a":"pin","b":"jaw","rule":"forbidden","margin_mm":0.5},
            {"a":"fin*","b":"pin","rule":"may_touch","depth_mm":0.1,"by":["slide"]}],
    "mate":[{"a":"pin","b":"finger","kind":"plane","tolerance_mm":0.01}],
    "guard":{"default_margin_mm":0.5,"nest":[0,0,1]}}"#;

#[test]
fn parts_of_a_scene_for_the_rig_are_checked() {
    scene(FOR_THE_RIG).unwrap();
    for (from, to, says) in [
        (
            r#""rides":"slide""#,
            r#""rides":"zz""#,
            r#"elements[0].rides: found "zz", expected the id of an actuator"#,
        ),
        (
            r#""half":[1,2,3]"#,
            r#""half":[1,2,3],"rides":"zz""#,
            r#"movers[0].rides: found "zz""#,
        ),
        (
            r#""id":"lift""#,
            r#""id":"slide""#,
            r#"actuator[1].id: found "slide" again"#,
        ),
        (
            r#""axis":[0,0,1]"#,
            r#""axis":[0,0,0]"#,
            "actuator[0].axis: found [0, 0, 0], expected a direction",
        ),
        (
            r#""axis":[0,0,1]"#,
            r#""axis":[0,NaN,1]"#,
            "actuator[0].axis[1]: found NaN",
        ),
        (
            r#""stroke_mm":12"#,
            r#""stroke_mm":-5"#,
            "actuator[0].stroke_mm: found -5, expected a stroke above 0",
        ),
        (
            r#","stroke_mm":12"#,
            "",
            "actuator[0].stroke_mm: found nothing",
        ),
        (
            r#""stroke_mm":12"#,
            r#""stroke_mm":12,"speed":3"#,
            "actuator[0].speed: found an unknown key",
        ),
        (
            r#""points_mm":[0,75]"#,
            r#""points_mm":[0,Infinity]"#,
            "actuator[1].points_mm[1]: found Infinity",
        ),
        (
            r#""points_mm":[0,75]"#,
            r#""points_mm":[0,75],"stroke_mm":75"#,
            "actuator[1].points_mm: found a list of 2, expected either",
        ),
        (
            r#""rides":"lift""#,
            r#""rides":"left""#,
            r#"actuator[1].rides: found "left""#,
        ),
        (
            r#"["finger"]"#,
            r#"["thumb"]"#,
            r#"actuator[1].opposed[0]: found "thumb", expected the id of a body"#,
        ),
        (
            r#""b":"jaw""#,
            r#""b":"nope""#,
            r#"pair[0].b: found "nope", expected the id of a body"#,
        ),
        (r#""b":"jaw","#, "", "pair[0].b: found nothing"),
        (
            r#""a":"fin*""#,
            r#""a":"fan*""#,
            r#"pair[1].a: found "fan*""#,
        ),
        (
            r#""rule":"forbidden""#,
            r#""rule":"kiss""#,
            r#"pair[0].rule: found "kiss", expected "forbidden", "may_touch" or "ignore""#,
        ),
        (
            r#""margin_mm":0.5}"#,
            r#""margin_mm":-3}"#,
            "pair[0].margin_mm: found -3, expected a distance",
        ),
        (
            r#""depth_mm":0.1"#,
            r#""depth_mm":"0.1""#,
            r#"pair[1].depth_mm: found "0.1""#,
        ),
        (
            r#""by":["slide"]"#,
            r#""by":["glide"]"#,
            r#"pair[1].by[0]: found "glide""#,
        ),
        (
            r#"[{"a":"pin","b":"finger","kind":"plane","tolerance_mm":0.01}]"#,
            "null",
            "mate: found null, expected a list",
        ),
        (
            r#"{"a":"pin","b":"finger","kind":"plane","tolerance_mm":0.01}"#,
            "3",
            "mate[0]: found 3, expected a table",
        ),
        (
            r#""b":"finger","kind""#,
            r#""b":"jaw","kind""#,
            r#"mate[0].b: found "jaw", expected the id of an element of the scene (pin, finger)"#,
        ),
        (
            r#""kind":"plane","tol"#,
            r#""kind":"round","tol"#,
            r#"mate[0].kind: found "round", expected "plane", "align" or "axis""#,
        ),
        (
            r#""tolerance_mm":0.01"#,
            r#""tolerance_mm":-1"#,
            "mate[0].tolerance_mm: found -1, expected a gap of 0 to 10 mm",
        ),
        (
            r#""default_margin_mm":0.5"#,
            r#""default_margin_mm":-1"#,
            "guard.default_margin_mm: found -1",
        ),
        (
            r#"[0,0,1]}}"#,
            r#"[0,0]}}"#,
            "guard.nest: found a list of 2",
        ),
    ] {
        let text = FOR_THE_RIG.replacen(from, to, 1);
        assert_ne!(text, FOR_THE_RIG, "{from:?} is not in the scene");
        let said = complaint(&text);
        assert!(said.starts_with(says), "{says}\n{said}");
    }
    for (whole, says) in [
        (r#"{"actuator":7}"#, "actuator: found 7, expected a list"),
        (
            r#"{"pair":"garbage"}"#,
            r#"pair: found "garbage", expected a list"#,
        ),
        (
            r#"{"guard":[]}"#,
            "guard: found a list of 0, expected a table",
        ),
    ] {
        assert!(complaint(whole).starts_with(says), "{}", complaint(whole));
    }
}

#[test]
fn a_scene_may_use_names_of_its_rig() {
    let text = r#"{"elements":[{"id":"jaw","kind":"block","half":[1,1,1],"rides":"clamp_left"}],
        "pair":[{"a":"part_*","b":"jaw","rule":"may_touch","by":["clamp_left"]}]}"#;
    assert!(complaint(text).starts_with("elements[0].rides: found \"clamp_left\", expected the id of an actuator of the scene or its rig; the scene has no actuators"));
    let rig_names = RigNames {
        actuators: &["clamp_left"],
        bodies: &["part_nest"],
    };
    let mut files = |_: &str| Err(MeshFault::File(String::new()));
    read_scene_of_rig(text, Format::Json, &mut files, &rig_names).unwrap();
}

#[test]
fn every_quaternion_except_zero_is_accepted() {
    let quarter = std::f64::consts::FRAC_1_SQRT_2;
    let unit = [quarter, 0.0, 0.0, quarter.next_down()];
    let read = |rotation: [f64; 4]| {
        let body = format!(
            r#"{{"elements":[{{"id":"b","kind":"block","half":[1,1,1],"pose":{{"rotation":{rotation:?}}}}}]}}"#
        );
        scene(&body).map(|scene| scene.elements[0].pose)
    };
    for exponent in [-1000, -700, -336, -332, 0, 332, 333, 700, 1023] {
        let long = unit.map(|member| member * 2.0_f64.powi(exponent));
        let pose = read(long).unwrap();
        assert_eq!(Frame::of(pose.rotation), Frame::of(unit), "2^{exponent}");
    }
    for long in [5e-324, 1e-320, 1e-101, 1e100, 1.7e308] {
        let pose = read([long, long, -long, long]).unwrap();
        assert_eq!(
            Frame::of(pose.rotation),
            Frame::of([1.0, 1.0, -1.0, 1.0]),
            "{long:e}"
        );
    }
    assert_eq!(read(unit).unwrap().rotation, unit);
    assert!(read([0.0, -0.0, 0.0, 0.0]).is_err());
}

#[test]
fn a_message_names_its_place_once_and_stays_short() {
    assert_eq!(
        complaint("null"),
        "the whole file: found null, expected a table"
    );
    let number = complaint(r#"{"elements":[{"id":"b","kind":"block","half":[1,1e300,3]}]}"#);
    assert!(number.starts_with("elements[0].half[1]: found 1e300, expected"));
    let number = complaint(r#"{"elements":[{"id":"b","kind":"block","half":[1,-1e-9,3]}]}"#);
    assert!(number.starts_with("elements[0].half[1]: found -1e-9, expected"));
    assert!(complaint(&format!(r#"{{"units":"{}"}}"#, "m".repeat(9_000))).len() < 200);
    let toml = format!("units = \"mm\"\nelements = [{}", "[1, 2], ".repeat(9_000));
    let said = read_scene(&toml, Format::Toml, &mut |_| {
        Err(MeshFault::File(String::new()))
    })
    .unwrap_err();
    let said = said.to_string();
    assert!(
        said.len() < 200 && said.lines().count() == 1 && said.contains("at line 2 column"),
        "{said}"
    );

    let scene = scene(PIN).unwrap();
    let wrong = |text: &str| read_moves(text, &scene).unwrap_err().to_string();
    assert_eq!(
        wrong("[]"),
        "line 1: the whole line: found a list of 0, expected a table"
    );
    assert_eq!(
        wrong("\n{\"id\""),
        "line 2: not readable: EOF while parsing an object at column 5"
    );
    let empty = read_moves(
        r#"{"id":"a","mover":"jaw","from":{},"to":{}}"#,
        &Scene::default(),
    );
    assert!(
        empty
            .unwrap_err()
            .to_string()
            .ends_with("; the scene has no movers")
    );
}

#[test]
fn a_byte_order_mark_is_skipped() {
    let read = scene(&format!("\u{feff}{PIN}")).unwrap();
    let toml = read_scene("\u{feff}units = \"mm\"", Format::Toml, &mut |_| {
        Err(MeshFault::File(String::new()))
    });
    assert_eq!(toml.unwrap(), Scene::default());
    let moves = "\u{feff}{\"id\":\"a\",\"mover\":\"jaw\",\"from\":{},\"to\":{}}";
    assert_eq!(read_moves(moves, &read).unwrap().len(), 1);
}

#[test]
fn a_long_number_keeps_all_its_digits() {
    let long =
        complaint(r#"{"elements":[{"id":"b","kind":"block","half":[1,1785118.2603991725,1]}]}"#);
    assert!(
        long.starts_with("elements[0].half[1]: found 1785118.2603991725, expected"),
        "{long}"
    );
}
