//! First steps with nothing but the program: a demo in an empty directory, a configuration of one's own.

use crate::program::Workshop;
use std::fs;
#[cfg(all(feature = "sim", unix))]
use {crate::serve::Served, serde_json::json};

/// Paths of all files below the working directory, sorted.
fn files(workshop: &Workshop) -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![workshop.folder.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => {
                    let within = path.strip_prefix(&workshop.folder).unwrap();
                    found.push(within.display().to_string());
                }
            }
        }
    }
    found.sort();
    found
}

#[cfg(all(feature = "sim", unix))]
#[test]
fn a_demo_in_an_empty_directory_tests_by_revised_recipes() {
    let workshop = Workshop::empty("first-demo");
    let demo =
        Served::over(workshop.start_logging("demo --listen 127.0.0.1:0 --speed 100 --count 1"));
    demo.until_state("Complete");
    let shown = demo.get("/api/recipes/show?name=jzc-22f-012");
    let values = json!({"limits.operate_voltage_v.high": 8.875});
    let change = json!({"name": "jzc-22f-012", "from": shown["hash"], "reason": "order 4711", "values": values});
    let (status, saved) = demo.post("/api/recipes/revise", &change);
    assert_eq!((status, &saved["kept"]), (200, &json!(false)), "{saved}");
    demo.start_lot("revised", 1);
    demo.until_complete("revised", 1);
    drop(demo);
    let part = workshop.run("--db relayrig-demo.db history show revised 1");
    assert!(part.with_status(0).stdout.contains("8.875"));
    let stray = files(&workshop);
    let stray = stray.iter().filter(|it| !it.starts_with("relayrig-demo"));
    assert_eq!(stray.collect::<Vec<_>>(), Vec::<&String>::new());
}

#[cfg(all(feature = "sim", unix))]
#[test]
fn a_demo_reads_the_directory_config_only_when_named() {
    let workshop = Workshop::empty("first-demo-config");
    fs::create_dir(workshop.folder.join("config")).unwrap();
    workshop.write("config/rig.toml", "[line]\n");
    let demo = "demo --listen 127.0.0.1:0";
    drop(Served::over(workshop.start_logging(demo)));
    let named = workshop.run(&format!("{demo} --config config"));
    assert!(named.with_status(2).stderr.contains("config/rig.toml:1: "));
}

#[test]
fn init_writes_a_configuration_that_passes_its_check() {
    let workshop = Workshop::empty("first-init");
    let said = workshop.run("init rig1").with_status(0);
    assert!(said.stdout.contains("config check --config rig1"), "{said}");
    let checked = workshop.run("config check --config rig1").with_status(0);
    assert!(checked.stdout.ends_with("ok\n"), "{checked}");
    let repository = Workshop::new("first-init-repository");
    let own = |name: &str| name.replace("config/", "rig1/");
    let mut expected = files(&repository);
    // The other rigs stay in the program; `init --rig` writes them.
    expected.retain(|name| !name.starts_with("config/rigs/"));
    assert_eq!(
        files(&workshop),
        expected.iter().map(|it| own(it)).collect::<Vec<_>>()
    );
    for name in expected {
        assert_eq!(workshop.read(&own(&name)), repository.read(&name), "{name}");
    }
}

#[test]
fn init_refuses_a_directory_that_is_not_empty() {
    let workshop = Workshop::empty("first-init-refused");
    workshop.write("notes.txt", "mine");
    for dir in [".", "notes.txt", "notes.txt/rig1"] {
        let said = workshop.run(&format!("init {dir}")).with_status(2);
        assert_eq!((said.stdout.as_str(), said.stderr.lines().count()), ("", 1));
    }
    assert_eq!(files(&workshop), ["notes.txt"]);
}

#[test]
fn a_command_without_configuration_names_init() {
    let workshop = Workshop::empty("first-without");
    for command in [
        "config check",
        "run --lot A --recipe jzc-22f-012",
        "serve --listen 127.0.0.1:0",
        "calibrate",
        "card --recipe jzc-22f-012",
    ] {
        let said = workshop.run(command).with_status(2);
        assert!(said.stderr.contains("`relayrig init config`"), "{said}");
        assert_eq!(said.stderr.lines().count(), 1, "{said}");
    }
    assert_eq!(files(&workshop), Vec::<String>::new());
}
