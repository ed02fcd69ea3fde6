//! What a material means for the ligaments and panels of an intended sheet, before windows are solved.
//!
//! Estimates for a ligament of width w in a sheet of thickness t, folded by theta (sections 4.2 and 5.1):
//!
//! | quantity | value |
//! |---|---|
//! | strain at which it buckles | (t / w)^2 / 2, at the rotation t / w |
//! | surface strain of a fold as long as the ligament is wide | t theta / (2 w) |
//! | plastic strain of its most strained 1 %, at the tip | 0.05 to 0.3 theta |
//! | critical panel edge, Gamma | (22), (21) |
//!
//! The range of the strain at the tip comes from window solves, tier `small`, of the five materials of Table 2 at w / t
//! = 18 and 36 and rotations of 45 and 60 degrees; docs/MATERIALS.md lists them.

use hinge::SheetMaterial;
use scene::analysis::localisation::{critical_edge, gamma};
use serde::Serialize;
use support::severity::{Finding, Severity};

/// The intended use of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intended {
    /// Minimum and maximum ligament width (mm).
    pub w_lig: [f64; 2],
    /// Panel edge (mm), if it is known.
    pub pitch: Option<f64>,
    /// Rotation of the hinges (rad).
    pub theta: f64,
}

/// Estimates for one ligament width.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LigamentEstimate {
    /// Ligament width (mm).
    pub w_lig: f64,
    /// Width over thickness.
    pub slenderness: f64,
    /// Rotation at which the ligament buckles (deg).
    pub buckles_at_deg: f64,
    /// Rotation at which the surface of the fold yields (deg).
    pub yields_at_deg: f64,
    /// Surface strain of the fold at the intended rotation.
    pub surface_strain: f64,
    /// Range of the plastic strain at the tip at the intended rotation.
    pub tip_strain: [f64; 2],
    /// L* (mm).
    pub critical_edge: f64,
    /// Gamma at the intended panel edge.
    pub gamma: Option<f64>,
}

/// All estimates and findings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaterialCheck {
    /// Hash of the law.
    pub law_hash: String,
    /// Yield stress over Young's modulus.
    pub yield_strain: f64,
    /// Estimates at the minimum and the maximum ligament width.
    pub ligaments: Vec<LigamentEstimate>,
    /// The most severe first. A note is a fact, a warning is to be checked before hours are spent, an error excludes the use.
    pub verdicts: Vec<Finding>,
}

/// Plastic strain of the most strained 1 % of a ligament over the rotation (1/rad).
const TIP_STRAIN: [f64; 2] = [0.05, 0.3];
/// Range of w / t of the shipped polyester data.
const KNOWN_SLENDERNESS: [f64; 2] = [10.0, 50.0];
/// Densities below this (kg/m^3) are densities of plastics and papers.
const LIGHTEST_METAL: f64 = 1700.0;
/// Maximum of Young's modulus over density of plastics without fibres and of papers (MPa m^3/kg); paper has up to 12.
const STIFFEST_PLASTIC: f64 = 12.0;
/// Slope of a softening table over Young's modulus at which coarse meshes still converge: the drop of the polyester film
/// from 44 to 33.6 MPa over a strain of 0.05.
const STEEPEST_DROP: f64 = 0.07;

impl MaterialCheck {
    /// Checks a valid material for an intended use with positive lengths and rotation.
    pub fn new(material: &SheetMaterial, intended: &Intended) -> Self {
        let [min, max] = intended.w_lig;
        let estimate = |w_lig| LigamentEstimate::new(material, intended, w_lig);
        let mut ligaments = vec![estimate(min)];
        ligaments.extend((max > min).then(|| estimate(max)));
        let mut verdicts = law(material);
        verdicts.extend(stiffness(material));
        verdicts.extend(buckling(material, &ligaments[0]));
        verdicts.extend(slenderness(&ligaments));
        verdicts.extend(panels(intended, &ligaments));
        verdicts.push(fracture(material, intended, &ligaments[0]));
        verdicts.sort_by_key(|verdict| std::cmp::Reverse(verdict.severity));
        Self {
            law_hash: material.law_hash(),
            yield_strain: yield_strain(material),
            ligaments,
            verdicts,
        }
    }
}

impl LigamentEstimate {
    fn new(material: &SheetMaterial, intended: &Intended, w_lig: f64) -> Self {
        let (t, theta) = (material.thickness, intended.theta);
        Self {
            w_lig,
            slenderness: w_lig / t,
            buckles_at_deg: (t / w_lig).to_degrees(),
            yields_at_deg: (2.0 * w_lig * yield_strain(material) / t).to_degrees(),
            surface_strain: t * theta / (2.0 * w_lig),
            tip_strain: TIP_STRAIN.map(|share| share * theta),
            critical_edge: critical_edge(material, w_lig),
            gamma: intended.pitch.map(|edge| gamma(material, w_lig, edge)),
        }
    }
}

fn yield_strain(material: &SheetMaterial) -> f64 {
    material.plastic[0][0] / material.young
}

/// Yield, hardening, softening, and the end of the table.
fn law(material: &SheetMaterial) -> Vec<Finding> {
    let SheetMaterial {
        plastic,
        young,
        fracture_strain,
        ..
    } = material;
    let [yields, _] = plastic[0];
    let [stress, strain] = plastic[plastic.len() - 1];
    let hardens = match plastic.len() {
        1 => "does not harden".to_owned(),
        _ => {
            let modulus = (stress - yields) / strain / young;
            format!(
                "has {stress} MPa at the plastic strain {strain}: a mean hardening modulus of {modulus:.4} E"
            )
        }
    };
    let percent = 100.0 * yield_strain(material);
    let yields =
        format!("the material yields at {yields} MPa, a strain of {percent:.2} %, and {hardens}");
    let mut verdicts = vec![Severity::Note.finding(yields)];
    let slope = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]) / (pair[1][1] - pair[0][1]);
    let drop = plastic
        .windows(2)
        .min_by(|a, b| slope(a).total_cmp(&slope(b)));
    if let Some(&[[from, start], [to, end]]) =
        drop.and_then(|pair| <&[[f64; 2]; 2]>::try_from(pair).ok())
        && to < from
    {
        let steepness = (from - to) / (end - start) / young;
        let fall = format!(
            "the table falls from {from} to {to} MPa between the plastic strains {start} and {end}"
        );
        verdicts.push(if steepness > STEEPEST_DROP {
            let steep = format!(
                "{fall}, by {steepness:.3} E: above {STEEPEST_DROP} E coarse meshes diverge; spread the fall over a longer \
                 strain"
            );
            Severity::Warning.finding(steep)
        } else {
            Severity::Note.finding(format!("{fall}: the material softens there"))
        });
    }
    if *fracture_strain > 1.05 * strain {
        let held = format!(
            "between the last row, at {strain}, and the fracture strain {fracture_strain} the window solver holds the \
             stress constant at {stress} MPa"
        );
        verdicts.push(Severity::Note.finding(held));
    }
    verdicts
}

/// Whether a material with the density of a plastic has the modulus of a plastic.
fn stiffness(material: &SheetMaterial) -> Option<Finding> {
    let [young, density] = [material.young, material.density_kg_m3];
    (density < LIGHTEST_METAL && young > STIFFEST_PLASTIC * density).then(|| {
        let message = format!(
            "young = {young} MPa is {:.0} MPa for each kg/m^3 of the density {density}: plastics without fibres have less than \
             {STIFFEST_PLASTIC}; in a tensile test check width, thickness, gauge length and units",
            young / density
        );
        Severity::Warning.finding(message)
    })
}

/// Whether the narrowest ligament buckles before it yields in its plane.
fn buckling(material: &SheetMaterial, narrowest: &LigamentEstimate) -> Option<Finding> {
    let yields = yield_strain(material);
    let buckles = 0.5 / narrowest.slenderness.powi(2);
    (buckles >= yields).then(|| {
        let width = material.thickness / (2.0 * yields).sqrt();
        let message = format!(
            "ligaments narrower than {width:.1} mm yield in their plane, at a strain of {yields:.4}, before they buckle, at \
             {buckles:.4} for {} mm: their windows converge in small increments or not at all",
            narrowest.w_lig
        );
        Severity::Warning.finding(message)
    })
}

/// Width over thickness against the range for which hinge data exist.
fn slenderness(ligaments: &[LigamentEstimate]) -> Option<Finding> {
    let [least, most] = KNOWN_SLENDERNESS;
    // Rounding of a width given as a multiple of the thickness.
    let slack = 1e-9;
    let known = least * (1.0 - slack)..=most * (1.0 + slack);
    let outside = ligaments
        .iter()
        .map(|ligament| (ligament.w_lig, ligament.slenderness))
        .filter(|(_, slenderness)| !known.contains(slenderness));
    let found: Vec<String> = outside
        .map(|(w_lig, slenderness)| format!("{w_lig} mm is {slenderness:.1} thicknesses"))
        .collect();
    (!found.is_empty()).then(|| {
        let message = format!(
            "a ligament of {}: the shipped hinge data cover {least} to {most}, so try a window (kirigami solve) before a \
             campaign",
            found.join(", of ")
        );
        Severity::Warning.finding(message)
    })
}

/// Gamma at the intended panel edge.
fn panels(intended: &Intended, ligaments: &[LigamentEstimate]) -> Option<Finding> {
    let pitch = intended.pitch?;
    let least = ligaments
        .iter()
        .min_by(|a, b| a.gamma.unwrap_or(0.0).total_cmp(&b.gamma.unwrap_or(0.0)))?;
    let gamma = least.gamma?;
    let at = format!(
        "panels of {pitch:.1} mm with ligaments of {} mm have Gamma = {gamma:.3} (L* = {:.0} mm)",
        least.w_lig, least.critical_edge
    );
    let (severity, weight) = if gamma < 1.0 {
        let weak = "below 1 its weight does not hold the panels down";
        (Severity::Warning, weak)
    } else {
        let enough = "its weight presses the panels down, which need not keep them flat";
        (Severity::Note, enough)
    };
    let message = format!("{at}, for a sheet that lies on a surface: {weight}");
    Some(severity.finding(message))
}

/// The strain at the tip against the fracture strain.
fn fracture(material: &SheetMaterial, intended: &Intended, ligament: &LigamentEstimate) -> Finding {
    let [least, most] = ligament.tip_strain;
    let limit = material.fracture_strain;
    let at = format!(
        "a fold of {:.0} deg strains the tip of a ligament by {least:.3} to {most:.3}; the fracture strain is {limit}",
        intended.theta.to_degrees()
    );
    let (severity, tears) = match (least >= limit, most >= limit) {
        (true, _) => (
            Severity::Error,
            "tears at its tip; reduce --theta-deg to the rotation that is needed",
        ),
        (_, true) => (Severity::Warning, "may tear at its tip"),
        _ => (Severity::Note, "does not tear"),
    };
    severity.finding(format!("{at}: the ligament {tears}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film() -> SheetMaterial {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let film = root.join("../configs/materials/pet-0.5mm.toml");
        SheetMaterial::load(&film).unwrap()
    }

    const PAPER: Intended = Intended {
        w_lig: [18.0, 18.0],
        pitch: Some(406.4),
        theta: 1.0,
    };

    fn check(change: impl Fn(&mut SheetMaterial), intended: Intended) -> MaterialCheck {
        let mut material = film();
        change(&mut material);
        MaterialCheck::new(&material, &intended)
    }

    /// Whether a verdict of the severity contains the text.
    fn says(check: &MaterialCheck, severity: Severity, text: &str) -> bool {
        let mut verdicts = check.verdicts.iter();
        verdicts.any(|found| found.severity == severity && found.message.contains(text))
    }

    #[test]
    fn the_film_of_the_paper_has_no_warning() {
        let check = check(|_| {}, PAPER);
        let mut verdicts = check.verdicts.iter();
        let notes = verdicts.all(|found| found.severity == Severity::Note);
        assert!(notes, "{check:?}");
        let [ligament] = check.ligaments[..] else {
            panic!("{check:?}")
        };
        // Of Table 2.
        assert!((ligament.critical_edge / 10.0 - 6.3).abs() < 0.05);
        assert!((250.0..350.0).contains(&ligament.gamma.unwrap()));
        assert_eq!(ligament.slenderness, 36.0);
        // At the rotation of yield the surface strain is the yield strain.
        let at_yield = 0.5 * ligament.yields_at_deg.to_radians() / 36.0;
        assert!((at_yield - 44.0 / 3000.0).abs() < 1e-12);
    }

    #[test]
    fn every_limit_has_its_verdict() {
        let pitch = Some(50.0);
        let small = Intended { pitch, ..PAPER };
        let w_lig = [3.0, 30.0];
        let narrow = Intended { w_lig, ..PAPER };
        let with = |change: fn(&mut SheetMaterial)| check(change, PAPER);
        let soft = check(|material| material.plastic[0][0] = 30.0, narrow);
        for (check, severity, text) in [
            (
                &with(|it| it.fracture_strain = 0.04),
                Severity::Error,
                "tears",
            ),
            (
                &with(|it| it.fracture_strain = 0.2),
                Severity::Warning,
                "may tear",
            ),
            (
                &with(|it| it.young = 30e3),
                Severity::Warning,
                "22 MPa for each kg/m^3",
            ),
            (
                &with(|it| it.plastic[1][1] = 0.02),
                Severity::Warning,
                "coarse meshes diverge",
            ),
            (
                &check(|_| {}, small),
                Severity::Warning,
                "does not hold the panels down",
            ),
            (
                &soft,
                Severity::Warning,
                "3 mm is 6.0 thicknesses, of 30 mm is 60.0",
            ),
            (&soft, Severity::Warning, "before they buckle"),
            (
                &with(|it| it.fracture_strain = 3.0),
                Severity::Note,
                "constant at 200 MPa",
            ),
        ] {
            assert!(says(check, severity, text), "{text}: {check:?}");
        }
    }
}
