//! Tests of the picture of the machine.

use super::*;

#[tokio::test]
async fn every_body_is_drawn_from_front_and_above() {
    let fixture = Fixture::new();
    let answer = fixture.get("/mimic.svg").await;
    assert_eq!(answer.headers["content-type"], "image/svg+xml");
    let svg = answer.text();
    for body in ["base&lt;plate&gt;", "finger", "part_nest"] {
        let named = format!("data-body=\"{body}\"");
        assert_eq!(svg.matches(&named).count(), 2, "{body}: {svg}");
    }
    assert!(!svg.contains("base<plate>"), "a name is text, never markup");
}

#[tokio::test]
async fn a_riding_body_has_its_way_in_each_view() {
    let svg = Fixture::new()
        .get("/mimic.svg")
        .await
        .text()
        .replace("&quot;", "\"");
    let rides = |right_down: &str| svg.contains(right_down);
    assert!(
        rides(r#"[["sort_z",0.0,1.0],["sort_axis",1.0,-0.0]]"#),
        "{svg}"
    );
    assert!(
        rides(r#"[["sort_z",0.0,-0.0],["sort_axis",1.0,-0.0]]"#),
        "{svg}"
    );
}
