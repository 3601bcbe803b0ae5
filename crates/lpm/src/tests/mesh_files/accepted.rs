//! Tests: variants of the file formats that must be accepted.
use super::*;

pub(super) fn shape(name: &str, bytes: &[u8]) -> Shape {
    match read(name, bytes, 1.0) {
        Ok(mut scene) => scene.elements.remove(0).shape,
        Err(said) => panic!("{}: {said}", String::from_utf8_lossy(bytes)),
    }
}

fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    String::from_utf8_lossy(bytes)
        .replace(from, to)
        .into_bytes()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn any_line_end_and_byte_order_mark_is_accepted() {
    let triangles = box_triangles(true);
    for (name, bytes) in [("a.stl", stl_text(&triangles)), ("a.obj", obj(&triangles))] {
        let plain = shape(name, &bytes);
        for end in ["\r", "\r\n", "\n\n", " \t\n "] {
            assert_eq!(shape(name, &replaced(&bytes, "\n", end)), plain, "{end:?}");
        }
        let marked = [b"\xef\xbb\xbf", &bytes[..]].concat();
        assert_eq!(shape(name, &marked), plain);
        assert_eq!(shape(name, bytes.trim_ascii_end()), plain);
    }
}

#[test]
fn names_and_comments_may_hold_any_letters() {
    let triangles = box_triangles(true);
    let text = stl_text(&triangles);
    let name = b"solid geh\xe4use facet \xff\xfe 1 2 3\n";
    let named = [&name[..], &text["solid box\n".len()..]].concat();
    assert_eq!(shape("a.stl", &named), shape("a.stl", &text));
    let text = obj(&triangles);
    let commented = [b"# geh\xe4use \\\no \xff # \xe4\n", &text[..]].concat();
    assert_eq!(shape("a.obj", &commented), shape("a.obj", &text));
}

#[test]
fn a_text_stl_accepts_capitals_and_several_solids() {
    let triangles = box_triangles(true);
    let text = stl_text(&triangles);
    let plain = shape("a.stl", &text);
    assert_eq!(shape("a.stl", &text.to_ascii_uppercase()), plain);
    let line = replaced(
        &replaced(&text, "\n", " "),
        "solid box facet",
        "solid\nfacet",
    );
    assert_eq!(shape("a.stl", &line), plain);
    let halves = triangles.chunks(6).flat_map(stl_text).collect::<Vec<u8>>();
    assert_eq!(shape("a.stl", &halves), plain);
    assert_eq!(shape("a.stl", &replaced(&halves, " box", "")), plain);
}

#[test]
fn a_backslash_continues_a_line() {
    let plain = shape("a.obj", format!("{SQUARE}f 1 2 3 4\n").as_bytes());
    for face in [
        "f 1 2 \\\n3 4",
        "f \\\r\n 1 2 \\\r\n 3 \\  \r\n4",
        "l 1 \\\n2\nf 1 2 3\\\n 4",
    ] {
        let text = format!("{SQUARE}g a \\\nb\n{face}");
        assert_eq!(shape("a.obj", text.as_bytes()), plain, "{face:?}");
    }
}

#[test]
fn statements_without_a_surface_are_skipped() {
    let plain = shape("a.obj", format!("{SQUARE}f 1 2 3 4\n").as_bytes());
    let text = "mtllib a b.mtl\no f\nv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5 # grey\nv 1 1 0 1 1 1 1\nv 0 1 0\nvt 0 0\n\
                vn 0 0 1\nvp 0\ng v f\ns off\nmg 1 1\nusemtl m#1\nusemap off\nlod 1\nbevel on\nshadow_obj a.obj\n\
                trace_obj a.obj\np 1\nl 1 2\nf 1/1/1 -3/1 3//1 4#last\n";
    assert_eq!(shape("a.obj", text.as_bytes()), plain);
}
