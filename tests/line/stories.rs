//! Stories of troubles: a script in `stories/NAME.txt`, the expected course in `NAME.told`. Stories of another rig lie
//! in a folder of their own.
//!
//! The course must match byte for byte. In every story no two bodies touch that must not, every body lies where its row
//! says, and every judged part has its row. `RELAYRIG_RENEW=1` in the environment rewrites the expected courses: read
//! the difference before committing it.

use crate::program::{Workshop, objects};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Stories that run at the same time, each in a process of its own.
const AT_ONCE: usize = 2;

/// Folders of stories, each with the options that choose rig and recipe.
const FOLDERS: [(&str, &str); 3] = [
    ("", ""),
    ("ssr-dc", "--config config/rigs/ssr --recipe ssr-dc-60v-3a"),
    (
        "ssr-ac",
        "--config config/rigs/ssr --recipe ssr-ac-240v-5a-zc",
    ),
];

/// Returns every script with the options of its folder.
fn scripts() -> Vec<(PathBuf, &'static str)> {
    let own = FOLDERS.into_iter();
    let own =
        own.flat_map(|(name, options)| scripts_in(name).into_iter().map(move |it| (it, options)));
    own.collect()
}

fn scripts_in(name: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/line/stories");
    let entries = fs::read_dir(folder.join(name)).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "txt"));
    files.sort();
    files
}

#[test]
fn every_story_takes_its_expected_course() {
    let left = Mutex::new(scripts());
    let broken = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some((script, options)) = { left.lock().unwrap().pop() } {
                    broken.lock().unwrap().extend(differences(&script, options));
                }
            });
        }
    });
    let broken = broken.into_inner().unwrap();
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
}

/// Plays a script and returns every difference from the expected course.
fn differences(script: &Path, options: &str) -> Vec<String> {
    let folder = script.parent().and_then(Path::file_name).unwrap();
    let name = script.file_stem().unwrap().to_string_lossy();
    let name = format!("{}-{name}", folder.to_string_lossy());
    let workshop = Workshop::new(&format!("story-{name}"));
    let said = workshop.run(&format!(
        "--db relayrig.db story {} {options} --truth t.jsonl",
        script.display()
    ));
    let file = script.with_extension("told");
    if std::env::var_os("RELAYRIG_RENEW").is_some() {
        fs::write(&file, &said.stdout).unwrap();
    }
    let mut broken = misplaced(&name, &workshop);
    if said.status != 0 || said.stdout.contains("TOUCHED") {
        broken.push(format!("{name}: {said}"));
    }
    if fs::read_to_string(&file).ok().as_deref() != Some(said.stdout.as_str()) {
        broken.push(format!(
            "{name}: differs from {} (RELAYRIG_RENEW=1 rewrites the file):\n{}",
            file.display(),
            said.stdout
        ));
    }
    broken
}

/// Returns bodies that lie elsewhere than their row says, or have no row.
fn misplaced(name: &str, workshop: &Workshop) -> Vec<String> {
    let landed = |body: &serde_json::Value| {
        let bin = body["landed_in"].as_str()?.to_owned();
        let seq = &body["seq"];
        let row = format!(
            "SELECT count(*) FROM part WHERE kind = 'lot' AND seq = {seq} AND bin = '{bin}'"
        );
        (workshop.count(&row) != 1)
            .then(|| format!("{name}: part {seq} lies in {bin}, its row names another bin"))
    };
    objects(&workshop.read("t.jsonl"))
        .iter()
        .filter_map(landed)
        .collect()
}

/// Instants after a nest exit, s, in a cycle of 1.4 s.
const INSTANTS: [f64; 4] = [0.05, 0.4, 0.75, 1.1];

#[test]
fn the_first_alarm_names_a_module_that_restarts() {
    let workshop = Workshop::new("module-restarts");
    for (number, instant) in INSTANTS.into_iter().enumerate() {
        for module in ["mech_do_a", "mech_do_b"] {
            let script = format!(
                "# {module} restarts.\nparts 4\n\nafter left 2 +{instant} fault reset={module}\n\
                 after state Aborted +1 order clear\nafter state Stopped order reset\n\
                 after state Idle order start\n"
            );
            workshop.write("script.txt", &script);
            let said = workshop.run(&format!("--db {module}-{number}.db story script.txt"));
            let alarm = said.stdout.lines().find(|row| row.contains("ALARM"));
            assert!(
                alarm.is_some_and(|row| row.contains(&format!("{module} has restarted"))),
                "{instant} s: {said}"
            );
        }
    }
}

/// Checks twelve instants of a cycle and twelve of homing; `study stop` takes any number.
#[test]
fn emergency_stop_at_any_instant_switches_off_in_time() {
    let workshop = Workshop::new("emergency-stops");
    let said = workshop
        .run("study stop --seeds 2 --parts 6 --json")
        .with_status(0);
    let rows = said.objects();
    let on = |place: &str| -> f64 {
        let own = rows.iter().filter(|row| {
            let figure = row["figure"].as_str().unwrap_or_default();
            figure.starts_with(&format!("reaction in {place}, "))
        });
        own.filter_map(|row| row["outputs_were_on"].as_f64()).sum()
    };
    assert!(on("a cycle") >= 6.0, "{said}");
    assert!(on("homing") >= 6.0, "{said}");
}
