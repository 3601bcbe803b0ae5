//! Bad input is refused, and the message names the input at fault.
use super::*;

fn two() -> Vec<Element> {
    vec![
        between("a", [0.0; 3], [1.0; 3]),
        between("b", [2.0; 3], [3.0; 3]),
    ]
}

fn refused(elements: Vec<Element>, omega: Option<Extent>, tolerance: Tolerance) -> PlanError {
    Assembly::new(elements, omega, tolerance, Vec::new()).unwrap_err()
}

#[test]
fn flawed_assemblies_are_refused_by_name() {
    let sound = Tolerance::default();
    let omega = Extent {
        low: [0.0; 3],
        high: [2.5; 3],
    };
    let found = refused(two(), Some(omega), sound);
    assert!(
        matches!(&found, PlanError::OutsideOmega { id, .. } if id == "b"),
        "{found}"
    );
    assert_eq!(
        found.to_string(),
        "element \"b\": found from [2.0, 2.0, 2.0] to [3.0, 3.0, 3.0] mm, \
         expected inside Omega from [0.0, 0.0, 0.0] to [2.5, 2.5, 2.5] mm"
    );
    let mut twice = two();
    twice[1].id = "a".to_owned();
    let found = refused(twice, None, sound);
    assert!(matches!(&found, PlanError::RepeatedId { found } if found == "a"));
    let mut overlapping = two();
    overlapping[1].pose.position = [0.9; 3];
    let found = refused(overlapping, None, sound);
    assert!(found.to_string().contains("\"a\" and \"b\""), "{found}");
    let mut flat = two();
    flat[0].shape = block([1.0, 0.0, 1.0]);
    assert!(matches!(
        refused(flat, None, sound),
        PlanError::Flawed { .. }
    ));
    for contact_mm in [0.0, -1.0, f64::NAN, 1.5] {
        let found = refused(
            two(),
            None,
            Tolerance {
                contact_mm,
                ..sound
            },
        );
        assert!(matches!(
            found,
            PlanError::Tolerance {
                key: "contact_mm",
                ..
            }
        ));
    }
    let mut far = two();
    far[0].pose.position = [-900_000.0, 0.0, 0.0];
    far[1].pose.position = [900_000.0, 0.0, 0.0];
    assert!(matches!(
        refused(far, None, sound),
        PlanError::OmegaTooLarge { .. }
    ));
}

#[test]
fn contradicting_demands_are_refused_by_name() {
    let assembly = assembled(two());
    let planner = Planner::new(&assembly, Vec::new()).unwrap();
    let ids = |ids: &[&str]| -> Vec<String> { ids.iter().map(|id| (*id).to_owned()).collect() };
    let refused = |demands: Demands| planner.disassembly(&demands).unwrap_err();
    let unknown = refused(Demands {
        remove: ids(&["c"]),
        ..Demands::default()
    });
    assert_eq!(
        unknown.to_string(),
        "remove: found \"c\", expected the id of an element"
    );
    let both = refused(Demands {
        remove: ids(&["a"]),
        stay: ids(&["a*"]),
        ..Demands::default()
    });
    assert!(matches!(both, PlanError::Contradiction { .. }));
    let split = refused(Demands {
        remove: ids(&["a"]),
        stay: ids(&["b"]),
        groups: vec![ids(&["a", "b"])],
        ..Demands::default()
    });
    assert!(matches!(split, PlanError::Contradiction { id, .. } if id == "b"));
    let nowhere = refused(Demands {
        forbidden: Direction::ALL.to_vec(),
        ..Demands::default()
    });
    assert_eq!(nowhere, PlanError::NoDirection);
}
