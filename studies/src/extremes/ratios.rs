//! A scene for a sheet of another thickness, size or material.
//!
//! With lambda the ratio of the thicknesses, mu that of the sizes and e that of Young's moduli, ligaments and windows grow
//! with lambda, the sheet and its displacements with mu. The energy of a hinge at an equal rotation grows with
//! e lambda^3, so couples do too, forces with e lambda^3 / mu, and the stiffnesses k_a and k_s with e lambda.

use design::objective::target::TargetShape;
use design::scene::{At, SceneConfig, rounded};

/// Ratios of a new sheet to the original one.
#[derive(Clone, Copy, Debug)]
pub struct Ratios {
    /// lambda.
    pub thickness: f64,
    /// mu.
    pub size: f64,
    /// e.
    pub young: f64,
}

impl Ratios {
    /// Scales a scene. Its thickness, material, hinge law and kerf, its holes and clips, and the files of its target, remain
    /// as they are.
    pub fn apply(self, config: &mut SceneConfig) {
        let Self {
            thickness,
            size,
            young,
        } = self;
        let energy = young * thickness.powi(3);
        let by = |factor: f64| move |x: f64| rounded(factor * x);
        let sheet = &mut config.sheet;
        sheet.size = sheet.size.map(|sides| sides.map(by(size)));
        sheet.corners = (sheet.corners).map(|corners| corners.map(|corner| corner.map(by(size))));
        let ligament = &mut config.ligament;
        ligament.start = by(thickness)(ligament.start);
        ligament.range = ligament.range.map(by(thickness));
        for width in config.start.w_lig.iter_mut().flatten() {
            *width = by(thickness)(*width);
        }
        // Not rounded: it must agree with the windows of the weights.
        config.process.r_win *= thickness;
        for support in &mut config.supports {
            support.displacement = support.displacement.map(by(size));
            scale_point(&mut support.at, size);
        }
        for load in &mut config.loads {
            scale_point(&mut load.at, size);
            load.mass_g = load.mass_g.map(by(energy / size));
            load.force = load.force.map(by(energy / size));
            load.couple = by(energy)(load.couple);
        }
        for load in &mut config.edge_loads {
            load.traction = load.traction.map(by(energy / size.powi(2)));
        }
        for load in &mut config.opening_couples {
            load.couple = by(energy)(load.couple);
        }
        if let Some(drive) = &mut config.drive {
            drive.stroke = by(size)(drive.stroke);
        }
        if let Some(linear) = &mut config.linear {
            linear.k_a = by(young * thickness)(linear.k_a);
            linear.k_s = by(young * thickness)(linear.k_s);
            linear.k_theta = by(energy)(linear.k_theta);
        }
        if let Some(contact) = &mut config.contact {
            contact.stiffness = by(energy)(contact.stiffness);
        }
        config.objective.min_panel_width = by(size)(config.objective.min_panel_width);
        config.objective.smoothing = by(size.powi(2))(config.objective.smoothing);
        scale_target(&mut config.target, size);
    }
}

fn scale_point(at: &mut At, factor: f64) {
    if let At::Point(position) = at {
        *position = position.map(|x| rounded(factor * x));
    }
}

fn scale_target(target: &mut TargetShape, factor: f64) {
    let by = |x: f64| rounded(factor * x);
    match target {
        TargetShape::Circle { centre, radius } => {
            *centre = centre.map(by);
            *radius = by(*radius);
        }
        TargetShape::Rectangle { centre, size, .. } => {
            *centre = centre.map(by);
            *size = size.map(by);
        }
        TargetShape::Polygon { vertices } | TargetShape::Curve { points: vertices } => {
            for vertex in vertices {
                *vertex = vertex.map(by);
            }
        }
        TargetShape::Svg { centre, height, .. } => {
            *centre = centre.map(by);
            *height = by(*height);
        }
        TargetShape::Csv { .. } => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use design::scene::{EdgeLoadConfig, OpeningCoupleConfig, SheetEdge};
    use std::path::Path;

    /// All lengths doubled: the energies grow by eight, the forces by four, the tractions by two.
    #[test]
    fn each_load_has_its_own_power_of_the_lengths() {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
        let mut config: SceneConfig =
            support::toml_file::read(&scenes.join("pet-3x3.toml")).unwrap();
        config.loads[0].force = [3.0, -1.0];
        config.loads[0].couple = 5.0;
        config.edge_loads = vec![EdgeLoadConfig {
            edge: SheetEdge::Left,
            traction: [0.5, 0.25],
        }];
        config.opening_couples = vec![OpeningCoupleConfig {
            panels: None,
            couple: 7.0,
        }];
        let r_win = config.process.r_win;
        let twice = Ratios {
            thickness: 2.0,
            size: 2.0,
            young: 1.0,
        };
        twice.apply(&mut config);
        assert_eq!(config.loads[0].force, [12.0, -4.0]);
        assert_eq!(config.loads[0].couple, 40.0);
        assert_eq!(config.edge_loads[0].traction, [1.0, 0.5]);
        assert_eq!(config.opening_couples[0].couple, 56.0);
        assert_eq!(config.process.r_win, 2.0 * r_win);
    }
}
