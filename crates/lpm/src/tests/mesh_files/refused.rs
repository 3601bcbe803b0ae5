//! Tests: damaged or ambiguous files, which must be refused.
use super::*;

pub(super) fn refusal(name: &str, bytes: &[u8]) -> String {
    match read(name, bytes, 1.0) {
        Ok(_) => panic!("accepted: {}", String::from_utf8_lossy(bytes)),
        Err(said) => said,
    }
}

fn lines(bytes: &[u8]) -> Vec<&[u8]> {
    bytes.split_inclusive(|byte| *byte == b'\n').collect()
}

#[test]
fn a_truncated_text_stl_is_refused() {
    let whole = stl_text(&box_triangles(true));
    let lines = lines(&whole);
    for kept in 0..lines.len() {
        let said = refusal("a.stl", &lines[..kept].concat());
        let expected = format!("line {}: found the end of the file, expected ", kept.max(1));
        assert!(said.contains(&expected), "{kept}: {said}");
    }
    for kept in 0..whole.len() - " box\n".len() {
        refusal("a.stl", &whole[..kept]);
    }
}

#[test]
fn an_stl_with_a_missing_or_repeated_line_is_refused() {
    let whole = stl_text(&box_triangles(true)[..2]);
    let lines = lines(&whole);
    for number in 0..lines.len() {
        let lost = [&lines[..number], &lines[number + 1..]].concat();
        refusal("a.stl", &lost.concat());
        let twice = [&lines[..=number], &lines[number..]].concat();
        refusal("a.stl", &twice.concat());
    }
    refusal("a.stl", &[&whole[..], b"0"].concat());
}

#[test]
fn stl_facets_of_four_and_two_corners_are_refused() {
    let text = String::from_utf8(stl_text(&box_triangles(true)[..2])).unwrap();
    let (vertex, rim) = (
        "  vertex -3e0 -4 -5\n",
        " endloop\nendfacet\nfacet normal 0 0 0\n outer loop\n",
    );
    let shifted = text.replace(&format!("{rim}{vertex}"), &format!("{vertex}{rim}"));
    assert_ne!(shifted, text);
    let said = refusal("a.stl", shifted.as_bytes());
    assert!(
        said.contains("line 7: found \"vertex\", expected \"endloop\""),
        "{said}"
    );
}

#[test]
fn mesh_file_errors_name_line_found_and_expected() {
    let facet =
        "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet";
    let hidden = format!("solid x {facet}\nendsolid x");
    let unnormal = format!(
        "solid\n{}\nendsolid",
        facet.replace("0 0 1 outer", "0 0 outer")
    );
    for (name, text, expected) in [
        (
            "a.stl",
            "",
            "line 1: found the end of the file, expected \"solid\"; a binary STL has 84 bytes or more, not 0",
        ),
        (
            "a.stl",
            "\nmesh",
            "line 2: found \"mesh\", expected \"solid\"; a binary",
        ),
        (
            "a.stl",
            "solid\n\nfacets",
            "line 3: found \"facets\", expected \"facet\" or \"endsolid\"",
        ),
        (
            "a.stl",
            "solid\nfacet\nnormal 0\n0 inf",
            "line 4: found \"inf\", expected a finite number",
        ),
        (
            "a.stl",
            "solid\nfacet normal 0 0 1,5",
            "line 2: found \"1,5\", expected a finite number",
        ),
        (
            "a.stl",
            "solid\n\0",
            "line 2: found a zero byte, expected text; a binary",
        ),
        (
            "a.stl",
            &unnormal,
            "line 2: found \"outer\", expected a finite number",
        ),
        (
            "a.stl",
            &hidden,
            "line 1: found \"facet normal\" in a name, expected it on its own line",
        ),
        (
            "a.obj",
            "v 0 0 0\n# \0\n",
            "line 2: found a zero byte, expected text",
        ),
        (
            "a.obj",
            "v 0 0 0 1 2",
            "line 1: found a vertex of 5 numbers, expected 3, 4 with a weight",
        ),
        ("a.obj", "v 0 0", "line 1: found a vertex of 2 numbers"),
        (
            "a.obj",
            "v 0 0 1e999",
            "line 1: found \"1e999\", expected a finite number",
        ),
        (
            "a.obj",
            "v 0 0 0 nan",
            "line 1: found \"nan\", expected a finite number",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 1",
            "line 2: found a face of 2 corners, expected 3 or more",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 1 2",
            "line 2: found \"2\", expected one of the 1 vertices above",
        ),
    ] {
        let said = refusal(name, text.as_bytes());
        assert!(said.contains(expected), "{text:?}: {said}");
    }
}

#[test]
fn a_binary_stl_of_wrong_length_is_refused() {
    let whole = stl_binary(&box_triangles(true));
    let expected = "a binary STL of 12 triangles has 684 bytes, not ";
    for length in 84..whole.len() {
        let said = refusal("a.stl", &whole[..length]);
        assert!(said.contains(&format!("{expected}{length}")), "{said}");
    }
    for length in 0..84 {
        refusal("a.stl", &whole[..length]);
    }
    let said = refusal("a.stl", &[&whole[..], b"\n"].concat());
    assert!(said.contains(&format!("{expected}685")), "{said}");
}

#[test]
fn a_binary_stl_with_a_nonfinite_corner_is_refused() {
    for nowhere in [f64::NAN, f64::INFINITY, -1e39] {
        let mut triangles = box_triangles(true);
        triangles[4][2][1] = nowhere;
        let said = refusal("a.stl", &stl_binary(&triangles));
        let expected = format!(
            "triangle 5: found {}, expected a finite number",
            nowhere as f32
        );
        assert!(said.contains(&expected), "{said}");
    }
}

#[test]
fn an_unknown_obj_keyword_is_refused() {
    for word in [
        "F", "V", "fo", "face", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm",
        "trim", "hole", "scrv", "sp", "end", "con", "ctech", "stech", "call", "csh", "bsp", "bzp",
        "cdc", "cdp", "res", "4", "\\",
    ] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n  {word} 1 2 3\n");
        let said = refusal("a.obj", text.as_bytes());
        assert!(
            said.contains(&format!("line 5: found {word:?}, expected ")),
            "{said}"
        );
    }
}

#[test]
fn a_malformed_face_corner_is_refused() {
    for corner in [
        "0", "4", "-4", "1.0", "1/", "1//", "1/0", "1/x", "1//y", "1/1/", "1/1/1/1", "/1", "",
        "1,2", "9e9",
    ] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {corner}\n");
        let said = refusal("a.obj", text.as_bytes());
        assert!(said.contains("line 4: found "), "{corner}: {said}");
    }
}

#[test]
fn an_ambiguous_backslash_is_refused() {
    let known = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    for (text, expected) in [
        ("f 1 2 3 \\", "line 5: found the end of the file"),
        ("f 1 2 3 \\\n", "line 5: found the end of the file"),
        ("f 1 2 3\\\n4\n", "line 5: found one word or two"),
        ("f 1 2 3 # round \\\n4\n", "line 6: found \"4\""),
        ("f 1 2 3 \\ # round\n4\n", "line 5: found \"\\\\\""),
        (
            "mtllib C:\\parts \\\nf 1 2 3 4\n",
            "line 5: found \"f\" behind a backslash, expected it on its own line",
        ),
        (
            "f 1 2 3 \\\nv 0 0 1\n",
            "line 5: found \"v\", expected one of the 4 vertices",
        ),
    ] {
        let said = refusal("a.obj", format!("{known}{text}").as_bytes());
        assert!(said.contains(expected), "{text:?}: {said}");
    }
}
