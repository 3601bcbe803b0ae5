//! Tests: a gauge study over HTTP.

use super::*;

#[tokio::test]
async fn a_gauge_study_is_evaluated_from_csv() {
    let fixture = Fixture::new();
    let rows = (0..18).map(|n| {
        let (part, operator, trial) = (n / 6, n / 3 % 2, n % 3);
        let value = f64::from(part) + 0.1 * f64::from(operator) + 0.01 * f64::from(trial);
        format!("\n{part},{operator},{trial},{value}")
    });
    let csv = format!("part,operator,trial,value{}", rows.collect::<String>());
    let body = serde_json::json!({ "csv": csv }).to_string();
    let post = |body: &str| {
        let request = Request::post("/api/quality/grr").header("content-type", "application/json");
        fixture.ask(request.body(Body::from(body.to_owned())).unwrap())
    };
    let found = post(&body).await.json();
    assert!(found["pct_grr"].as_f64().unwrap() < 20.0, "{found}");
    let reason = post(r#"{"csv":"part,value\n1,2"}"#).await.refused(400);
    assert!(reason.contains("column operator is missing"), "{reason}");
}
