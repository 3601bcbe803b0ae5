//! Serves the simulated rig alone, on pseudo-terminals in real time, until the process is killed.
//!
//! `rigsim [--config DIR] [--seed N] [--world FILE] [--recipe NAME] [--fault NAME[=VALUE]]...
//! [--bench FILE] [--link DIR]`; the first line of stdout is a JSON object with the port of each line.

use std::path::PathBuf;
use std::process::ExitCode;

use rigsim::pty::{self, Ptys, Rates};
use rigsim::{Files, Options, SharedRig, SimError};

struct Arguments {
    options: Options,
    bench: Option<PathBuf>,
    link: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = match arguments(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(why) => {
            eprintln!("rigsim: {why}");
            return ExitCode::from(2);
        }
    };
    match serve(&arguments) {
        Ok((_rig, _ptys)) => loop {
            std::thread::park();
        },
        Err(error) => {
            eprintln!("rigsim: {error}");
            ExitCode::from(2)
        }
    }
}

fn serve(arguments: &Arguments) -> Result<(SharedRig, Ptys), SimError> {
    let rig = match &arguments.bench {
        Some(file) => rigsim::build_bench(file, &arguments.options.faults)?,
        None => rigsim::build(&arguments.options)?,
    };
    let ptys = pty::serve(&rig, Rates::Ignored)?;
    if let Some(dir) = &arguments.link {
        ptys.link(dir)?;
    }
    let lines: serde_json::Map<String, serde_json::Value> = ptys
        .paths()
        .into_iter()
        .map(|(name, path)| (name, path.display().to_string().into()))
        .collect();
    println!("{}", serde_json::json!({ "lines": lines }));
    Ok((rig, ptys))
}

fn arguments(mut given: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut arguments = Arguments {
        options: Options {
            files: Files::Directory("config".into()),
            world: None,
            seed: 1,
            recipe: "jzc-22f-012".into(),
            parts: None,
            reference_parts: true,
            faults: Vec::new(),
        },
        bench: None,
        link: None,
    };
    while let Some(name) = given.next() {
        let value = given
            .next()
            .ok_or_else(|| format!("{name}: a value is missing"))?;
        let options = &mut arguments.options;
        match name.as_str() {
            "--config" => options.files = Files::Directory(value.into()),
            "--world" => options.world = Some(value.into()),
            "--recipe" => options.recipe = value,
            "--fault" => options.faults.push(value),
            "--bench" => arguments.bench = Some(value.into()),
            "--link" => arguments.link = Some(value.into()),
            "--seed" => {
                options.seed = value
                    .parse()
                    .map_err(|_| format!("--seed: found `{value}`, expected a whole number"))?;
            }
            unknown => return Err(format!("`{unknown}` is no option")),
        }
    }
    Ok(arguments)
}
