//! Tests: no row is lost or doubled when links are cut at drawn bytes, senders dropped at drawn instants and the server
//! killed. `FLEET_STORM` gives the size: rigs, parts of each, cuts, kills of senders, kills of the server.

use crate::proxy::Proxy;
use crate::rig::Rig;
use crate::server::Server;
use fleet::set_up;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Size of the storm in CI: rigs, parts per rig, then least numbers of cuts, dropped senders and killed servers.
const SMALL: [u64; 5] = [3, 200, 12, 10, 2];
/// Parts that each rig adds before a round.
const PER_ROUND: u64 = 5;
/// Most bytes that a connection carries before it is cut; a batch of 200 parts has more.
const CUT_WITHIN: u64 = 40_000;

fn size() -> [u64; 5] {
    let Ok(given) = std::env::var("FLEET_STORM") else {
        return SMALL;
    };
    let numbers: Vec<u64> = given.split(',').map(|it| it.parse().unwrap()).collect();
    numbers.try_into().unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nothing_is_lost_or_doubled_when_everything_dies() {
    let [rigs, parts, cuts, drops, kills] = size();
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let proxy = Proxy::start(server.port, CUT_WITHIN, 7).await;
    let dropped = Arc::new(AtomicU64::new(0));
    let all: Vec<Arc<Rig>> = (0..rigs)
        .map(|n| {
            let rig = Rig::new(&format!("rig-{n}"));
            rig.run("A", parts, 4);
            Arc::new(rig)
        })
        .collect();

    let mut rounds = 0;
    let mut killed = 0;
    while proxy.cuts.load(Ordering::Relaxed) < cuts
        || dropped.load(Ordering::Relaxed) < drops
        || killed < kills
    {
        rounds += 1;
        assert!(rounds < 10 * (cuts + drops + kills), "troubles do not come");
        let target = server.target("owner", proxy.port);
        let mut sending = Vec::new();
        for (n, rig) in (0..).zip(&all) {
            rig.run(&format!("L{rounds}"), PER_ROUND, 4);
            let (rig, target, dropped) = (Arc::clone(rig), target.clone(), Arc::clone(&dropped));
            let mut random = Xoshiro256PlusPlus::seed_from_u64(rounds * 1000 + n);
            let patience = Duration::from_millis(random.next_u64() % 1000);
            sending.push(tokio::task::spawn(async move {
                // The time-out drops the sender at any point of its work, as a kill would.
                if tokio::time::timeout(patience, rig.push(&target))
                    .await
                    .is_err()
                {
                    dropped.fetch_add(1, Ordering::Relaxed);
                }
            }));
        }
        let kill = killed < kills && rounds.is_multiple_of(3);
        if kill {
            server.kill();
            killed += 1;
        }
        for it in sending {
            it.await.unwrap();
        }
        if kill {
            server.begin();
        }
    }

    proxy.heal();
    for rig in &all {
        rig.push(&server.target("owner", proxy.port)).await.unwrap();
    }
    for (n, rig) in all.iter().enumerate() {
        for table in ["run", "part", "measurement", "sample", "reason"] {
            let key = if table == "run" || table == "part" {
                "id"
            } else {
                "part_id"
            };
            let of_rig = format!(
                "SELECT count(*) FROM relayrig.{table} WHERE {key} >> 40 = (SELECT history.id FROM
                relayrig.history JOIN relayrig.rig ON rig.id = rig_id WHERE rig = 'rig-{n}')"
            );
            assert_eq!(
                server.number(&of_rig).await,
                rig.number(&format!("SELECT count(*) FROM {table}")),
                "{table} of {n}"
            );
        }
        assert_eq!(
            rig.number("SELECT count(*) FROM outbox"),
            0,
            "a queue has rows"
        );
    }
    let doubled =
        "SELECT count(*) FROM (SELECT part_id, parameter_id, attempt FROM relayrig.measurement
        GROUP BY 1, 2, 3 HAVING count(*) > 1) AS double";
    assert_eq!(server.number(doubled).await, 0);
    println!(
        "{rigs} rigs, {rounds} rounds, {} cuts, {} senders dropped, {killed} kills of the server: 0 lost, 0 doubled",
        proxy.cuts.load(Ordering::Relaxed),
        dropped.load(Ordering::Relaxed)
    );
}
