//! Each flaw of a computer and the advice that it gets.

#![allow(clippy::unwrap_used)]

use super::super::cpu_time::CpuTime;
use super::super::facts::RealTimeShare;
use super::super::verdict::tests::verdict;
use super::*;

/// Facts of a computer without a flaw.
fn good() -> Facts {
    Facts {
        program: "/usr/local/bin/relayrig".into(),
        is_fifo: true,
        memory_locked: true,
        governors: vec!["performance".into(); 4],
        preemption: Some(Preemption::Full),
        real_time_share: Some(RealTimeShare {
            runtime_us: 950_000,
            period_us: 1_000_000,
        }),
        cpu_time: CpuTime {
            cpu_ms: 20_000.0,
            stolen_ms: 0.0,
        },
        ..Facts::default()
    }
}

#[test]
fn each_flaw_has_its_own_advice() {
    let governors = ["performance", "powersave", "powersave"].map(str::to_owned);
    // Flaw, subject and found of the advice, part of its remedy.
    type Flaw = fn(&mut Facts);
    let table: [(Flaw, &str, &str, &str); 4] = [
        (
            |it| it.is_fifo = false,
            "SCHED_FIFO",
            "no right",
            "cap_sys_nice=ep /usr/local/bin/relayrig",
        ),
        (
            |it| (it.memory_locked, it.memory_limit) = (false, Some(8_388_608)),
            "locked memory",
            "8192 kB",
            "LimitMEMLOCK",
        ),
        (
            |it| it.preemption = Some(Preemption::Absent),
            "kernel",
            "no preemption",
            "preempt=full",
        ),
        (
            |it| it.cpu_time.stolen_ms = 400.0,
            "hypervisor",
            "400 ms of CPU time stolen during the test (2.0 %)",
            "real hardware",
        ),
    ];
    for (flaw, subject, found, remedy) in table {
        let mut facts = good();
        flaw(&mut facts);
        let all = advise(&facts, &verdict(420.0, 0.1));
        assert_eq!(all.len(), 1, "{all:?}");
        assert_eq!(all[0].subject, subject);
        assert!(all[0].found.contains(found), "{all:?}");
        assert!(all[0].remedy.as_ref().unwrap().contains(remedy));
    }
    let slow = Facts {
        governors: governors.to_vec(),
        ..good()
    };
    let all = advise(&slow, &verdict(420.0, 0.1));
    assert_eq!(all[0].found, "powersave (2 of 3 CPUs)");
}

#[test]
fn a_good_computer_gets_no_advice() {
    assert_eq!(advise(&good(), &verdict(420.0, 0.1)), []);
    let quiet_guest = Facts {
        is_virtual: true,
        ..good()
    };
    assert_eq!(advise(&quiet_guest, &verdict(420.0, 0.1)), []);
}

#[test]
fn a_share_below_95_percent_is_too_small() {
    let table = [(-1, true), (950_000, true), (949_999, false), (0, false)];
    for (runtime_us, is_enough) in table {
        let share = RealTimeShare {
            runtime_us,
            period_us: 1_000_000,
        };
        assert_eq!(share.is_enough(), is_enough, "{runtime_us}");
        let facts = Facts {
            real_time_share: Some(share),
            ..good()
        };
        let all = advise(&facts, &verdict(420.0, 0.1));
        assert_eq!(all.is_empty(), is_enough, "{all:?}");
    }
}

#[test]
fn a_late_computer_gets_a_cause() {
    let subjects = |facts: &Facts, worst_ms| {
        let all = advise(facts, &verdict(420.0, worst_ms));
        all.into_iter().map(|it| it.subject).collect::<Vec<_>>()
    };
    let accepted = "safety.estop_reaction_ms in rig.toml";
    assert_eq!(subjects(&good(), 40.0), ["kernel and firmware", accepted]);
    let guest = Facts {
        is_virtual: true,
        ..good()
    };
    assert_eq!(subjects(&guest, 40.0), ["hypervisor", accepted]);
    let text = advise(&guest, &verdict(420.0, 100.0))[1].to_string();
    assert!(text.contains("found 2.1 ms left for late waits, expected 100.0 ms"));
    assert!(text.contains("accept 518 ms"), "{text}");
}
