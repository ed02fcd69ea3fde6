//! A new sheet as a service cuts it: with holes, slits and material next to them that are large
//! enough for the service.

use anyhow::{Context, Result, ensure};
use design::sheet::cutting_process::HoleSize;
use output::cut_file::{Features, Machines};
use scene::SceneConfig;
use std::f64::consts::FRAC_PI_2;
use support::nearest::unknown;

/// What is added to the limits of a service (mm).
const ROOM: f64 = 0.05;
/// The narrowest ligaments over the widest ones, at most: a search chooses among those between.
const NARROWEST: f64 = 0.95;

/// Gives a scene of a sheet of the given thickness (mm) the tool and the ligaments for a service.
pub(super) fn for_service(config: &mut SceneConfig, name: &str, thickness: f64) -> Result<()> {
    let services = Machines::shipped().service;
    let service = services.iter().find(|service| service.name == name);
    let known = services.iter().map(|service| &*service.name);
    let service = service.with_context(|| unknown("service", name, known))?;
    let least = service.limits(thickness);
    let [narrowest, widest] = config.ligament.range;
    let process = &mut config.process;
    if process.slit_width < least.slot {
        process.slit_width = least.slot;
        // The service cuts around its slots and allows for the width that its tool removes.
        config.cutting.kerf = None;
    }
    // A hole is wider than the slit that ends in it.
    let hole = least.hole.max(process.slit_width + 2.0 * ROOM);
    if 2.0 * process.hinge(narrowest, FRAC_PI_2).fillet_ratio * narrowest < hole {
        process.hole = HoleSize::Diameter(hole);
        // Its law is for holes that grow with the ligament.
        if let Some(surrogate) = &mut config.surrogate {
            surrogate.springback = None;
        }
    }
    let bridge = least.bridge.max(least.edge) + ROOM;
    let radius = |w_lig: f64| process.hinge(w_lig, FRAC_PI_2).fillet_ratio * w_lig;
    let narrowest = narrowest.max(bridge + radius(widest));
    ensure!(
        narrowest <= NARROWEST * widest,
        "{name} wants holes of {hole:.2} mm and {bridge:.2} mm next to them at this thickness, and ligaments of this material are at most \
         {widest:.2} mm wide: choose another service"
    );
    config.ligament.range = [narrowest, widest];
    config.ligament.start = config.ligament.start.max(0.5 * (narrowest + widest));
    let radius = radius(narrowest);
    let features = Features {
        hole: 2.0 * radius,
        slot: process.slit_width,
        bridge: narrowest - radius,
        edge: narrowest - radius,
        size: config.sheet.size.unwrap_or_default(),
    };
    let refuses = service.refusals(&features, thickness);
    ensure!(refuses.is_empty(), "{name} refuses {}", refuses.join("; "));
    Ok(())
}
