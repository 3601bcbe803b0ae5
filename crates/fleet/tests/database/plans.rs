//! Questions find their rows in the large tables by an index, as the server itself counts it.

use crate::answers;
use crate::server::Server;
use fleet::generate::{VALUES, Wanted, generate};
use fleet::set_up;
use history::inquiry::figures::figures;
use history::{Archive, Filter};

const WANTED: Wanted = Wanted {
    parts: 16_000,
    rigs: 10,
    days: 300,
};

/// Returns how many measurements the server has read by reading partitions whole, and how often it used an index.
async fn reads(server: &Server) -> [i64; 2] {
    let count = |column: &str| {
        format!(
            "SELECT sum({column})::bigint FROM pg_stat_user_tables WHERE relname LIKE 'measurement\\_2%'"
        )
    };
    let (whole, by_index) = (count("seq_tup_read"), count("idx_scan"));
    [server.number(&whole).await, server.number(&by_index).await]
}

/// Waits until the server has noted what ended sessions read.
async fn until_noted(server: &Server) {
    let others = "SELECT count(*) FROM pg_stat_activity WHERE application_name = 'relayrig'";
    while server.number(others).await > 0 {}
}

fn ask(all: &Archive, of_rig: &Archive) {
    let of_lot = Filter {
        lot: Some("L-3-1".to_owned()),
        ..Filter::default()
    };
    let filter = Filter {
        verdict: Some("fail".to_owned()),
        param: Some("made_up_7_v".to_owned()),
        min: Some(7.0),
        ..of_lot.clone()
    };
    assert!(!of_rig.query(&filter).unwrap().is_empty());
    let found = figures(of_rig, "made_up_3_v", &of_lot, None).unwrap();
    assert_eq!(found.summary.n, 1000);
    let life = all.of_serial("S-5-1234").unwrap();
    assert_eq!(life[0].values.len() as i64, VALUES);
}

#[test]
fn questions_find_measurements_by_an_index() {
    let server = Server::start();
    answers::wait(async {
        set_up(&server.owner()).await.unwrap();
        generate(&server.owner(), WANTED, |_| {}).await.unwrap();
        until_noted(&server).await;
    });
    let before = answers::wait(reads(&server));
    ask(
        &answers::database(&server, None),
        &answers::database(&server, Some("rig-003")),
    );
    let after = answers::wait(async {
        until_noted(&server).await;
        reads(&server).await
    });
    assert_eq!(after[0], before[0], "a question has read a whole partition");
    assert!(after[1] > before[1], "{before:?} {after:?}");
}

#[test]
fn made_up_rigs_never_join_real_ones() {
    let server = Server::start();
    answers::wait(async {
        set_up(&server.owner()).await.unwrap();
        let rig = crate::rig::Rig::new("rig-1");
        rig.run("A", 3, 1);
        rig.push(&server.owner()).await.unwrap();
        let refused = generate(&server.owner(), WANTED, |_| {}).await.unwrap_err();
        assert!(
            refused
                .to_string()
                .contains("found rigs of the plant suzhou"),
            "{refused}"
        );
    });
}
