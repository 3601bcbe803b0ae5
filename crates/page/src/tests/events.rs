//! Tests of the event stream under tokio's paused clock.

use super::*;
use axum::body::BodyDataStream;
use futures_util::StreamExt;
use std::time::Duration;
use tokio::time::{Instant, interval_at};

async fn stream(fixture: &Fixture) -> BodyDataStream {
    let request = Request::get("/api/events").body(Body::empty()).unwrap();
    let response = fixture.router.clone().oneshot(request).await.unwrap();
    assert_eq!(response.headers()["content-type"], "text/event-stream");
    response.into_body().into_data_stream()
}

async fn next(stream: &mut BodyDataStream) -> Option<String> {
    let piece = stream.next().await?.unwrap();
    Some(String::from_utf8(piece.to_vec()).unwrap())
}

fn judged(event: &str) -> Option<u64> {
    let data = event.lines().find_map(|line| line.strip_prefix("data: "))?;
    serde_json::from_str::<serde_json::Value>(data).unwrap()["judged"].as_u64()
}

#[tokio::test(start_paused = true)]
async fn a_stream_sends_a_view_then_beats_each_second() {
    let fixture = Fixture::new();
    let (began, mut stream) = (Instant::now(), stream(&fixture).await);
    let first = next(&mut stream).await.unwrap();
    assert!(first.contains("event: view\n") && first.contains("retry: 1000\n"));
    assert_eq!((judged(&first), began.elapsed()), (Some(3), Duration::ZERO));
    for second in 1..4 {
        let beat = next(&mut stream).await.unwrap();
        assert_eq!(beat, "event: beat\ndata: {\"alive\":true}\n\n");
        assert_eq!(began.elapsed().as_secs(), second);
    }
}

#[tokio::test(start_paused = true)]
async fn at_most_20_views_a_second_and_the_last() {
    let fixture = Fixture::new();
    let mut stream = stream(&fixture).await;
    next(&mut stream).await.unwrap();
    let began = Instant::now();
    for judged in 0..1000 {
        fixture.view.send_modify(|view| view.judged = judged);
        tokio::task::yield_now().await;
    }
    assert_eq!(judged(&next(&mut stream).await.unwrap()), Some(999));
    assert!(began.elapsed() >= Duration::from_millis(50));
    assert!(next(&mut stream).await.unwrap().contains("beat"));
}

#[tokio::test(start_paused = true)]
async fn an_idle_rig_sends_one_view_a_second() {
    let fixture = Fixture::new();
    let mut stream = stream(&fixture).await;
    next(&mut stream).await.unwrap();
    let (began, mut views) = (Instant::now(), 0);
    let period = Duration::from_millis(50);
    let turns = async {
        let mut turns = interval_at(began + period, period);
        loop {
            turns.tick().await;
            fixture.view.send_modify(|view| {
                view.at_us += 50_000;
                view.machine
                    .phases_s
                    .insert("scan".into(), view.at_us as f64);
            });
        }
    };
    let events = async {
        while began.elapsed() < Duration::from_secs(10) {
            views += u32::from(next(&mut stream).await.unwrap().contains("event: view"));
        }
    };
    tokio::select! { () = turns => {}, () = events => {} }
    assert!((9..=10).contains(&views), "{views}");
}

#[tokio::test(start_paused = true)]
async fn a_busy_rig_does_not_suppress_the_beat() {
    let fixture = Fixture::new();
    let mut stream = stream(&fixture).await;
    let (mut views, mut beats) = (0, 0);
    let end = Instant::now() + Duration::from_secs(10);
    while Instant::now() < end {
        let event = next(&mut stream).await.unwrap();
        match event.contains("event: beat") {
            true => beats += 1,
            false => views += 1,
        }
        fixture.view.send_modify(|view| view.judged += 1);
    }
    assert!((9..=11).contains(&beats), "{beats}");
    assert!((190..=202).contains(&views), "{views}");
}

#[tokio::test(start_paused = true)]
async fn without_a_controller_the_beat_is_not_alive() {
    let mut fixture = Fixture::new();
    let mut stream = stream(&fixture).await;
    next(&mut stream).await.unwrap();
    fixture.end_of_the_controller().await;
    for _ in 0..3 {
        assert!(next(&mut stream).await.unwrap().contains("\"alive\":false"));
    }
}

#[tokio::test(start_paused = true)]
async fn streams_end_with_the_program_and_its_count() {
    let fixture = Fixture::new();
    let mut streams = Vec::new();
    for _ in 0..50 {
        let mut stream = stream(&fixture).await;
        next(&mut stream).await.unwrap();
        streams.push(stream);
    }
    assert!(
        fixture
            .get("/metrics")
            .await
            .text()
            .contains("relayrig_screens 50\n")
    );
    fixture.ended.send_replace(true);
    for mut stream in streams {
        assert_eq!(next(&mut stream).await, None);
    }
    assert!(
        fixture
            .get("/metrics")
            .await
            .text()
            .contains("relayrig_screens 0\n")
    );
}
