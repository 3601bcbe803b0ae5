//! `relayrig demo`: the main job with nothing to prepare.

use super::rig::{self, PaceArg, RigArgs};
use super::run::{self, Controls, Orders, RunArgs, assemble};
use crate::config::{Plant, load_recipe};
use crate::hmi::{self, access};
use crate::view::Mimic;
use anyhow::Context;
use std::path::Path;
use std::sync::Arc;
use std::thread::JoinHandle;
use tokio::sync::{mpsc, watch};

/// The main job with nothing to prepare.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig demo
  relayrig demo --listen 127.0.0.1:9000 --fault fall
  relayrig demo --speed 5")]
pub struct DemoArgs {
    /// Where the page listens
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:8080")]
    pub listen: std::net::SocketAddr,
    /// Fault of the simulated rig, see `relayrig sim --faults`
    #[arg(long, value_name = "NAME[=VALUE]")]
    pub fault: Vec<String>,
    /// In virtual time at X times the speed of the wall clock, instead of through pseudo-terminals
    #[arg(long, value_name = "X", value_parser = rig::speed)]
    pub speed: Option<f64>,
    /// Draws rig and lot
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Parts of the lot; without it the lot goes on until it is stopped
    #[arg(long, value_name = "N")]
    pub count: Option<u64>,
}

/// Runs the command; the result is the exit status.
pub fn run(config: &Path, db: &Path, args: &DemoArgs) -> anyhow::Result<i32> {
    let listener = std::net::TcpListener::bind(args.listen)
        .with_context(|| format!("--listen {}: the page cannot listen there", args.listen))?;
    let address = listener.local_addr().context("the page's socket")?;
    let controls = Controls {
        stays: true,
        ..Controls::new(false)
    };
    let (orders, asked) = mpsc::channel(hmi::WAITING);
    let lot = format!("demo {}", jiff::Zoned::now().strftime("%Y-%m-%d %H:%M:%S"));
    let order = RunArgs {
        rig: RigArgs {
            sim: true,
            pace: match args.speed {
                Some(_) => PaceArg::Virtual,
                None => PaceArg::Real,
            },
            speed: args.speed,
            seed: args.seed,
            world: None,
            fault: args.fault.clone(),
            line: Vec::new(),
        },
        lot,
        recipe: "jzc-22f-012".into(),
        count: args.count,
        truth: None,
        retest: None,
        json: false,
        study: None,
    };
    let plant = Plant::load(config)?;
    let recipe = load_recipe(config, &order.recipe)?;
    let mimic = assemble::mimic(&plant, &recipe)?;
    let page = Page::start(listener, &controls, orders, db, mimic)?;
    eprintln!(
        "relayrig: simulated rig running, page at http://{}/, history in {}, Ctrl-C stops",
        address,
        db.display()
    );
    let status = run::run_with(config, db, &order, &controls, Orders::Screens(asked));
    page.end();
    status
}

/// The page on a thread of its own, so that the line never waits for a screen.
struct Page {
    ended: watch::Sender<bool>,
    thread: JoinHandle<()>,
}

impl Page {
    fn start(
        listener: std::net::TcpListener,
        controls: &Controls,
        orders: mpsc::Sender<hmi::Asked>,
        db: &Path,
        mimic: Mimic,
    ) -> anyhow::Result<Self> {
        listener
            .set_nonblocking(true)
            .context("the page's socket")?;
        let people = access::beside(db);
        let (gate, first) = hmi::Gate::open(&people)?;
        if let Some((name, password)) = first {
            eprintln!(
                "relayrig: log in as {name} with {password} (told this once; people are in {})",
                people.display()
            );
        }
        let shared = hmi::Shared {
            gate,
            mimic: Arc::new(mimic),
            view: controls.view.subscribe(),
            traffic: hmi::Traffic::new(controls.traffic()),
            db: db.to_path_buf(),
            orders,
        };
        let (ended, seen) = watch::channel(false);
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = std::thread::spawn(move || {
            let served = runtime.block_on(async {
                let listener = tokio::net::TcpListener::from_std(listener)?;
                hmi::serve(listener, shared, seen).await
            });
            if let Err(error) = served {
                tracing::error!("the page ended: {error}");
            }
        });
        Ok(Self { ended, thread })
    }

    fn end(self) {
        self.ended.send_replace(true);
        if self.thread.join().is_err() {
            tracing::error!("the page ended by an assertion");
        }
    }
}
