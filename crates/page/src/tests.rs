//! Tests of every route as a client without a browser sees it.

#![allow(clippy::unwrap_used)]

mod api;
mod approval;
mod calibration;
mod conformance;
mod document;
mod events;
mod external;
mod gauge;
mod history;
mod login;
mod lots;
mod mimic;
mod orders;
mod people;
mod plans;
mod recipes;
mod rejudge;
mod routes;
mod server;

use super::access::{Register, Role, SetupCode, access_path};
use super::{Sessions, Shared, Traffic, WAITING, asked, router};
use axum::Router;
use axum::body::{Body, to_bytes};
use axum::http::{Request, StatusCode};
use config::Folder;
use machine::view::{LastPart, LineTraffic, Message, Mimic, MimicBody, OrderRequest, View};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use tokio::sync::{mpsc, watch};
use tokio::task::JoinHandle;
use tower::ServiceExt;

/// Password of all people of the tests.
const PASSWORD: &str = "open sesame";

/// Orders that reached the audit as denied, one line each.
type Denied = Arc<Mutex<Vec<String>>>;

/// A server with the other ends of its channels.
struct Fixture {
    view: watch::Sender<View>,
    ended: watch::Sender<bool>,
    stop: Arc<AtomicBool>,
    denied: Denied,
    /// True while the controller takes every order.
    willing: Arc<AtomicBool>,
    controller: JoinHandle<()>,
    orders: mpsc::Sender<OrderRequest>,
    router: Router,
    db: PathBuf,
    sessions: Sessions,
    /// Code that adds the first engineer; the file of people has none yet.
    setup: SetupCode,
    /// Token of an operator's session.
    token: String,
}

impl Fixture {
    fn new() -> Self {
        Self::over(new_folder().join("history.db"))
    }

    fn over(db: PathBuf) -> Self {
        let config = some_config(&db);
        Self::with(db, config)
    }

    fn with(db: PathBuf, config: Folder) -> Self {
        let (view, looking) = watch::channel(some_view());
        let (ended, over) = watch::channel(false);
        let stop = Arc::new(AtomicBool::new(false));
        let denied = Denied::default();
        let (orders, asked) = mpsc::channel(WAITING);
        let willing = Arc::new(AtomicBool::new(false));
        let controller = tokio::spawn(controller(
            asked,
            Arc::clone(&stop),
            Arc::clone(&willing),
            Arc::clone(&denied),
        ));
        let mut register = Register::open(&access_path(&db)).unwrap();
        for (name, role) in [("li", Role::Operator), ("wang", Role::Maintainer)] {
            register.add(name, role, PASSWORD, 0).unwrap();
        }
        let now_us = jiff::Timestamp::now().as_microsecond();
        let token = register.open_session("li", now_us).unwrap();
        let (sessions, setup) = Sessions::open(&db).unwrap();
        let shared = Shared {
            sessions: sessions.clone(),
            mimic: Arc::new(some_mimic()),
            view: looking,
            traffic: some_traffic(),
            plans: Arc::new(plans::OneStep),
            db: db.clone(),
            config,
            orders: orders.clone(),
        };
        let router = router::router(shared, over);
        Self {
            view,
            ended,
            stop,
            denied,
            willing,
            controller,
            orders,
            router,
            db,
            sessions,
            setup: setup.unwrap(),
            token,
        }
    }

    /// Sends the request; checks that the answer is as the OpenAPI document says.
    async fn ask(&self, request: Request<Body>) -> Answer {
        let (method, path) = (request.method().clone(), request.uri().path().to_owned());
        let response = self.router.clone().oneshot(request).await.unwrap();
        let (parts, body) = response.into_parts();
        let body = to_bytes(body, usize::MAX).await.unwrap();
        let answer = Answer {
            status: parts.status,
            headers: parts.headers,
            body: body.to_vec(),
        };
        conformance::check(&method, &path, &answer);
        answer
    }

    async fn get(&self, path: &str) -> Answer {
        self.ask(Request::get(path).body(Body::empty()).unwrap())
            .await
    }

    /// Sends a GET request with this `Accept-Language` header.
    async fn get_in(&self, languages: &str, path: &str) -> Answer {
        let request = Request::get(path).header("accept-language", languages);
        self.ask(request.body(Body::empty()).unwrap()).await
    }

    async fn order(&self, body: impl Into<Body>) -> Answer {
        let request = Request::post("/api/orders").header("content-type", "application/json");
        let request = request.header("authorization", self.bearer());
        self.ask(request.body(body.into()).unwrap()).await
    }

    fn register(&self) -> Register {
        Register::open(&access_path(&self.db)).unwrap()
    }

    /// Opens a session with this role; returns its token.
    fn session(&self, role: Role) -> String {
        let mut register = self.register();
        // Fails without harm when an earlier call has added the person.
        let _ = register.add(role.word(), role, PASSWORD, 0);
        let now_us = jiff::Timestamp::now().as_microsecond();
        register.open_session(role.word(), now_us).unwrap()
    }

    fn bearer(&self) -> String {
        format!("Bearer {}", self.token)
    }

    /// Ends the controller: views stop.
    async fn end_of_the_controller(&mut self) {
        self.view = watch::channel(View::default()).0;
        self.controller.abort();
        let _ = (&mut self.controller).await;
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }
}

/// Accepts `stop` and the orders of a maintainer, refuses all others.
async fn controller(
    mut asked: mpsc::Receiver<OrderRequest>,
    stop: Arc<AtomicBool>,
    willing: Arc<AtomicBool>,
    denied: Denied,
) {
    while let Some(asked) = asked.recv().await {
        if let Some(why) = &asked.denied {
            denied.lock().unwrap().push(format!(
                "{} {} {}: {}",
                asked.by.role,
                asked.by.who,
                asked.order.word(),
                why.say(texts::Lang::En)
            ));
            continue;
        }
        let answer = match asked.order.word().as_str() {
            "stop" => {
                stop.store(true, Ordering::SeqCst);
                Ok(None)
            }
            "reset" | "start" | "hold" | "unhold" | "abort" | "clear"
                if !willing.load(Ordering::SeqCst) =>
            {
                Err(texts::Message::new("refusal", "run_ended"))
            }
            _other => Ok(None),
        };
        asked.answer(answer);
    }
}

impl Drop for Fixture {
    fn drop(&mut self) {
        if let Some(folder) = self.db.parent() {
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}

struct Answer {
    status: StatusCode,
    headers: axum::http::HeaderMap,
    body: Vec<u8>,
}

impl Answer {
    fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.body).unwrap()
    }

    fn text(&self) -> &str {
        std::str::from_utf8(&self.body).unwrap()
    }

    /// Returns the reason of a refusal; panics on another status.
    fn refused(&self, status: u16) -> String {
        assert_eq!(self.status.as_u16(), status, "{}", self.text());
        let json = self.json();
        assert!(json["error"].is_string());
        json["reason"].as_str().unwrap().to_owned()
    }
}

/// Creates a folder that stays after the test.
fn new_folder() -> PathBuf {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let name = format!("relayrig-hmi-{}-{number}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Copies the configuration beside the history.
fn some_config(db: &Path) -> Folder {
    let original = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config");
    let copy = db.with_file_name("config");
    std::fs::create_dir_all(copy.join("recipes")).unwrap();
    for file in [
        "rig.toml",
        "scene.toml",
        "golden.toml",
        "card.toml",
        "recipes/jzc-22f-006.toml",
        "recipes/jzc-22f-012.toml",
    ] {
        std::fs::copy(original.join(file), copy.join(file)).unwrap();
    }
    Folder::Directory(copy)
}

fn some_mimic() -> Mimic {
    let square = vec![vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]];
    let body = |id: &str, rides: &[(&str, [f64; 3])]| MimicBody {
        id: id.to_owned(),
        rides: rides
            .iter()
            .map(|(it, way)| ((*it).to_owned(), *way))
            .collect(),
        above: square.clone(),
        front: square.clone(),
    };
    let lift = [("sort_z", [0.0, 0.0, -1.0]), ("sort_axis", [1.0, 0.0, 0.0])];
    Mimic {
        bodies: vec![
            body("base<plate>", &[]),
            body("finger", &lift),
            body("part_nest", &[]),
        ],
    }
}

fn some_traffic() -> Traffic {
    Traffic::new(|last| {
        let message = Message {
            way: ">".into(),
            text: "@11A2\\r".into(),
            ..Message::default()
        };
        vec![LineTraffic {
            line: "motion".into(),
            entries: vec![message; last.min(300)],
        }]
    })
}

fn some_view() -> View {
    View {
        simulated: true,
        lot: "A".into(),
        recipe: "jzc-22f-012".into(),
        state: "running".into(),
        judged: 3,
        count: Some(20),
        verdicts: [("pass".to_owned(), 2), ("fail".to_owned(), 1)].into(),
        bins: [("pass".to_owned(), 2)].into(),
        last: Some(LastPart {
            seq: 3,
            verdict: "pass".into(),
            ..LastPart::default()
        }),
        ..View::default()
    }
}
