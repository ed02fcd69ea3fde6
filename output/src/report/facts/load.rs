//! How the sheet is held, and its weight.

use super::{Fact, fact, text};
use crate::report::deployed::{Deployed, Run};
use crate::report::numbers::rounded;
use analysis::localisation::elasto_gravity_length;
use analysis::unit::Unit;
use scene::FRICTION;

pub(super) fn holding_and_weight(of: &Deployed, run: &Run) -> Vec<Fact> {
    if !of.scene.hinge.carries_load() {
        return Vec::new();
    }
    let attachments = of.scene.actuation().attachments.into_iter().map(|attachment| {
        let panel = &of.deployment.sheet.panels[attachment.panel];
        let [x, y] = panel.position(attachment.point).map(|x| rounded(x, 5));
        let mut said = format!("{}, at ({x}, {y}) mm", attachment.name);
        for (what, size) in [("hole", attachment.hole), ("clip", attachment.clip)] {
            said += &size.map_or(String::new(), |size| format!(", {what} {} mm", rounded(size, 4)));
        }
        text(["attachment"; 2], said)
    });
    let weight = &run.weight;
    let modelled = if weight.is_modelled { "modelled" } else { "not modelled" };
    let said = format!("{}; {modelled}", weight.relative_to_load(1.0));
    let mut facts: Vec<Fact> = attachments.collect();
    facts.push(fact(["weight"; 2], weight.weight, Unit::Newton, said));
    if weight.lies() {
        let force = weight.relative_to_load(FRICTION);
        let sliding =
            format!("{force}, while all panels slide at mu = {FRICTION}; not in the design");
        facts.push(fact(["friction"; 2], FRICTION * weight.weight, Unit::Newton, sliding));
        let length = elasto_gravity_length(&of.scene.material);
        let ratio = rounded(length / of.scene.config.process.r_win, 2);
        facts.push(fact(
            ["bending_length", "bending by weight"],
            length,
            Unit::Millimetre,
            format!("l_eg {} mm, {ratio} times the radius of a window", rounded(length, 3)),
        ));
    }
    facts
}
