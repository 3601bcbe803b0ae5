//! `relayrig bus`: finds modules, sends one command, watches a line, converts signals of sensors; needs no configuration.

mod found;
mod monitor;
mod scan;
mod send;
mod sensor;

use anyhow::Context;
use app::exit::Exit;
use bus::{LineSettings, open_serial};
use std::path::PathBuf;
use tokio_serial::SerialStream;

/// Tools for a line of modules.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig bus scan --port /dev/ttyUSB0
  relayrig bus scan --port /tmp/rig/bench --baud 115200 --addresses 01-20 --json
  relayrig bus send --port /dev/ttyUSB0 --baud 9600 --checksum '$012'
  relayrig bus monitor --port /dev/ttyUSB0 --baud 115200
  relayrig bus monitor --from http://127.0.0.1:8080
  relayrig bus monitor --trace relayrig.alarm-1-motion.trace --level bytes
  relayrig bus sensor --type 22 45 85 120")]
pub struct BusArgs {
    #[command(subcommand)]
    command: BusCommand,
}

#[derive(Debug, clap::Subcommand)]
enum BusCommand {
    /// Find modules: address, baud and checksum, name, firmware, configuration
    Scan(scan::ScanArgs),
    /// Send one command and decode the reply
    Send(send::SendArgs),
    /// Watch a line without sending, or read the trace of an alarm
    Monitor(monitor::MonitorArgs),
    /// Convert temperatures to signals of a sensor, and back
    Sensor(sensor::SensorArgs),
}

/// The port of the modules.
#[derive(Debug, Clone, clap::Args)]
struct PortArgs {
    /// Serial port, or a link to it
    #[arg(long, value_name = "PATH")]
    port: PathBuf,
}

impl PortArgs {
    fn open(&self, baud: u32) -> anyhow::Result<SerialStream> {
        let path = self.port.to_string_lossy();
        open_serial(&path, baud).with_context(|| format!("--port {path}"))
    }

    fn settings(&self, baud: u32, checksum: bool) -> LineSettings {
        let mut settings = LineSettings::new(&self.port.to_string_lossy(), baud);
        settings.checksum = checksum;
        settings
    }
}

/// Runs `relayrig bus`; an error is bad input (exit status 2).
pub fn run(args: &BusArgs) -> anyhow::Result<Exit> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .context("starting the runtime")?;
    let done = runtime.block_on(async {
        match &args.command {
            BusCommand::Scan(args) => scan::run(args).await,
            BusCommand::Send(args) => send::run(args).await,
            BusCommand::Monitor(args) => monitor::run(args).await,
            BusCommand::Sensor(args) => sensor::run(args),
        }
    });
    super::unless_pipe_closed(done, Exit::Done)
}
