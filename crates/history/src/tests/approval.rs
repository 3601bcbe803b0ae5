//! Tests: engineers whose signatures stand under a recipe.

use super::*;
use serde_json::json;
use texts::Message;

fn order(who: &str, role: &str, at_us: i64, order: &str, hash: &str) -> OrderRecord {
    OrderRecord {
        at_us,
        who: who.into(),
        role: role.into(),
        what: json!({"order": order, "recipe": "R", "hash": hash}).to_string(),
        ..OrderRecord::default()
    }
}

#[test]
fn only_engineers_who_saved_or_approved_a_text_sign_it() {
    let file = File::new();
    assert!(signatures(&file.path, "R", "a").unwrap().is_empty());
    let refused = OrderRecord {
        refused: Some(Message::new("refusal", "signed_already")),
        ..order("wu", "engineer", 6, "approve", "a")
    };
    let rows = [
        order("zhao", "engineer", 1, "revise", "a"),
        order("zhao", "", 2, "revise", "b"),
        order("chen", "engineer", 3, "approve", "a"),
        order("chen", "engineer", 4, "approve", "a"),
        order("li", "operator", 5, "approve", "a"),
        order("sun", "engineer", 7, "new_recipe", "b"),
        order("sun", "engineer", 8, "mode", "a"),
        refused,
    ];
    file.store().record(&rows.map(Row::Order)).unwrap();
    let signed = |recipe, hash| {
        let all = signatures(&file.path, recipe, hash).unwrap();
        all.into_iter()
            .map(|it| (it.who, it.at.0))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        signed("R", "a"),
        [("zhao".to_owned(), 1), ("chen".to_owned(), 3)]
    );
    assert_eq!(signed("R", "b"), [("sun".to_owned(), 7)]);
    assert!(signed("S", "a").is_empty());
}
