//! Tests: results from outside of the rig arrive once, and the database judges a lot by them as the file does.

use crate::answers::{database, wait};
use crate::rig::Rig;
use crate::server::Server;
use fleet::{set_up, start_again};
use history::Archive;

#[test]
fn results_from_outside_arrive_once_and_unchanged() {
    let server = Server::start();
    wait(set_up(&server.owner())).unwrap();
    let rig = Rig::new("rig-1");
    rig.external("E");
    wait(rig.push(&server.owner())).unwrap();
    let same = || {
        let (file, there) = (
            Archive::open(&rig.db).unwrap(),
            database(&server, Some("rig-1")),
        );
        let ask = |archive: &Archive| {
            let standing = archive.external_standing("E").unwrap().unwrap();
            (archive.external_results("E").unwrap(), standing)
        };
        assert_eq!(ask(&there), ask(&file));
        ask(&there)
    };
    let (results, standing) = same();
    assert_eq!(results.len(), 4);
    assert!(!standing.acceptable && standing.undecided == 1 && standing.fail == 0);

    rig.enter("E", "key,value,u\ndwv_ua,3.1,0.2");
    wait(rig.push(&server.owner())).unwrap();
    assert!(same().1.acceptable);
    let view = "SELECT count(*) FROM relayrig.external_results WHERE lot = 'E' AND rig = 'rig-1'";
    let superseded = format!("{view} AND superseded AND verdict IN ('fail', 'undecided')");
    assert_eq!(wait(server.number(view)), 5);
    assert_eq!(wait(server.number(&superseded)), 2);
    let (settings, target) = (rig.settings(&server.owner()), server.owner());
    wait(start_again(&mut rig.outbox(), &settings, &target)).unwrap();
    wait(rig.push(&server.owner())).unwrap();
    assert_eq!(wait(server.number(view)), 5, "no result arrived twice");
    same();
}
