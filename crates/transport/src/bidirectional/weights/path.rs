//! A whole path, and how often each technique finds it by the definition.

use super::fog::Fog;
use super::{PANEL_AREA, is_dense};
use crate::film::limits::MAX_CONNECTED_ROW;
use crate::media::interaction::{Interaction, MediumPoint};
use crate::path_tracing::passes_straight;
use crate::sampling::task::Task;
use crate::techniques::{PerSet, TechniqueCounts};
use bilux_math::transcendental::{atan2_f64, exp_f64};
use bilux_math::{Vec2, Vec3};
use bilux_scene::TransportMode;
use std::f64::consts::{FRAC_PI_2, PI};

/// A vertex between the light and the camera, in both directions as the code has evaluated it.
#[derive(Clone)]
pub(super) struct PathVertex {
    /// Position and normal (zero in a medium), as the light subpath reached them and as the camera subpath did: not quite the same where
    /// the two merge.
    pub(super) from_light: (Vec3, Vec3),
    pub(super) from_camera: (Vec3, Vec3),
    pub(super) at: Interaction,
    pub(super) to_light: Vec3,
    pub(super) to_camera: Vec3,
    /// Whether its event was a delta event.
    pub(super) is_delta: bool,
}

/// The path's end at the light.
#[derive(Clone, Copy)]
pub(super) struct Start {
    pub(super) index: usize,
    /// `None` where the light is infinitely far away.
    pub(super) p: Option<Vec3>,
    pub(super) cos: f32,
}

/// A path from the light to the camera.
pub(super) struct Path {
    pub(super) start: Start,
    pub(super) nodes: Vec<PathVertex>,
    /// The density of camera rays at the last vertex, over the area perpendicular to them.
    pub(super) camera_density: f32,
    /// The fog that it goes through.
    pub(super) fog: Option<Fog>,
}

/// A factor that is left out of the densities, or a mistake in them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Flaw {
    None,
    Cosine,
    Distance,
    LightChoice,
    Choice,
    ChoiceElsewhere,
    PickedTwice,
    MergedTwice,
    Direct,
    Reverse,
    /// The probability of coming so far is left out.
    Survival,
    /// Two points of a medium are connected in long rows too.
    Row,
    /// The angle between beams that cross is left out, or that beams stand for all events along them.
    Sine,
    Extinction,
    /// Points are merged in a larger ball.
    Ball,
    /// Equiangular points are left out, or are as frequent as events of walks.
    Points,
    WalkedPoints,
    /// Splats of light straight from a light are left out.
    UnseenCones,
    /// Lights are not sampled through panes, or are chosen there by the pane's place.
    Panes,
    ChoiceAtPane,
}

impl Path {
    /// Frequency with which each technique finds this path, by (merges, s).
    pub(super) fn densities(
        &self,
        task: &Task,
        techniques: &TechniqueCounts,
        flaw: Flaw,
    ) -> Vec<((bool, usize), f64)> {
        let count = self.nodes.len();
        let (light, camera) = (self.light_subpaths(task, flaw), self.camera_subpaths(task, flaw));
        let TechniqueCounts { splats, connections, eta, beams, points, .. } = techniques;
        let [splats, connections, eta, beams, points] =
            [splats, connections, eta, beams, points].map(|counts| f64::from(counts.0[0]));
        // Light subpaths may leave direct light to camera subpaths, or merging to splats.
        let unmerged = flaw != Flaw::Direct
            && match &self.nodes[0].at {
                Interaction::Surface(..) => !techniques.direct,
                Interaction::Medium(point) => !techniques.direct && point.is_equiangular,
            };
        let is_in_fog = self.nodes[0].at.is_in_medium();
        let leaves_direct = unmerged && !(techniques.splats_cones && is_in_fog && flaw != Flaw::UnseenCones);
        // Vertices are numbered from 1; the light is 0 and the camera is count + 1.
        let is_open = |i: usize| i == 0 || i > count || !self.nodes[i - 1].is_delta;
        let mut all = Vec::new();
        for (s, t) in (0..=count + 1).map(|s| (s, count + 2 - s)) {
            let copies = match (s, t) {
                (0, _) => 1.0,
                // No technique connects a light with the camera.
                (1, 1) | (_, 0) => continue,
                (1, _) if flaw == Flaw::PickedTwice => 2.0,
                (1, _) => 1.0,
                (2, 1) if leaves_direct => 0.0,
                (_, 1) => splats,
                _ => connections,
            };
            let is_short =
                |s: usize| flaw == Flaw::Row || s < 2 || t < 2 || self.row_at(s) <= MAX_CONNECTED_ROW;
            if s == 0 || (is_open(s - 1) && is_open(s) && is_short(s)) {
                all.push(((false, s), copies * light[s] * camera[t]));
            }
        }
        if let Some((panes, picked)) = self.picked_through_panes(task, flaw) {
            all.push(((false, 1 + panes), picked * camera[count + 1 - panes]));
        }
        if let Some(ratio) = self.equiangular(task, flaw) {
            all.push(((true, 1), light[1] * camera[count + 1] * ratio));
        }
        for i in (1..=count).filter(|i| is_open(*i)) {
            let node = &self.nodes[i - 1];
            let copies = match i {
                1 if unmerged => 0.0,
                _ if node.at.is_in_medium() => match self.ball(task, node, techniques, flaw) {
                    Some(volume) => points * volume,
                    None => beams * self.crossing(node, flaw),
                },
                _ if flaw == Flaw::MergedTwice => 2.0 * eta,
                _ => eta,
            };
            all.push(((true, i + 1), copies * light[i + 1] * camera[count + 2 - i]));
        }
        all
    }

    /// The number of panes next to the light, and how often the vertex behind them samples the light, over the density 1 per solid angle of passing each
    /// pane; `None` where there are none, or where it does not.
    fn picked_through_panes(&self, task: &Task, flaw: Flaw) -> Option<(usize, f64)> {
        let panes = self.nodes.iter().take_while(|node| node.is_pane(task)).count();
        let vertex = self.nodes.get(panes).filter(|node| !node.is_delta && !node.at.is_in_medium())?;
        if panes == 0 || flaw == Flaw::Panes {
            return None;
        }
        let at = if flaw == Flaw::ChoiceAtPane { &self.nodes[panes - 1] } else { vertex };
        let cosines = self.nodes[..panes].iter().map(|pane| cosine(pane.from_light.1, pane.to_light, flaw));
        let lengths = self.nodes[..=panes].windows(2).map(|pair| 1.0 / edge(&pair[0], &pair[1], flaw));
        let passing: f64 = cosines.chain(lengths).product();
        let p = vertex.from_light.0;
        let straight = self.start.p.map_or(1.0, |start| {
            distance2(start, p, flaw) / distance2(start, self.nodes[0].from_light.0, flaw)
        });
        let chosen = task.context.lights.probability(self.start.index, Some(at.from_light.0));
        Some((panes, self.direct(task, p) * f64::from(chosen) * passing * straight))
    }

    /// The density with which a point samples the start on the light: over area, or over solid angle where that is infinitely far away.
    fn direct(&self, task: &Task, from: Vec3) -> f64 {
        let light = &task.context.scene.lights()[self.start.index].light;
        f64::from(match (light.is_delta(), light.is_infinite()) {
            (true, _) => 1.0,
            (false, true) => light.li_pdf_solid_angle(from, self.nodes[0].to_light, None),
            (false, false) => 1.0 / PANEL_AREA,
        })
    }

    /// The number of points in a row in media around the edge that connects `s` vertices from the light with the rest; 0 where one
    /// of its ends is on a surface.
    fn row_at(&self, s: usize) -> u32 {
        let is_inside = |node: &&PathVertex| node.at.is_inside();
        let (before, behind) = self.nodes.split_at(s - 1);
        let rows =
            [before.iter().rev().take_while(is_inside).count(), behind.iter().take_while(is_inside).count()];
        if rows.contains(&0) { 0 } else { rows.iter().sum::<usize>() as u32 }
    }

    /// Number of equiangular points where the vertex next to the light is, for each event of a walk; `None` where there are none.
    fn equiangular(&self, task: &Task, flaw: Flaw) -> Option<f64> {
        let (scene, first) = (task.context.scene, &self.nodes[0]);
        let Interaction::Medium(MediumPoint { is_equiangular: true, .. }) = first.at else { return None };
        if self.nodes.get(1).is_some_and(|next| next.at.is_in_medium()) {
            return None;
        }
        let (middle, reach) = scene.lights()[self.start.index].light.middle_and_reach()?;
        let (p, to_camera) = (first.from_camera.0.as_dvec3(), first.to_camera.as_dvec3());
        let t = match self.nodes.get(1) {
            Some(next) => p.distance(next.from_light.0.as_dvec3()),
            None => {
                let seen = task.context.camera.connect(first.from_camera.0, Vec2::ZERO, first.at.time())?;
                p.distance(seen.p.as_dvec3())
            }
        };
        let [origin, middle] = [p + to_camera * t, middle.as_dvec3()];
        // The tangent of the angle, whose range is infinite at one end, changes with the distance.
        let nearest = -(middle - origin).dot(to_camera);
        let apart2 = (middle - origin + to_camera * nearest).length_squared()
            + f64::from(reach) * f64::from(reach)
            + 1e-6 * (middle - origin).length_squared();
        let apart = apart2.sqrt();
        let range = FRAC_PI_2 + atan2_f64(nearest, apart);
        let density = apart / (apart2 + (t - nearest) * (t - nearest)) / range;
        let begin = (p + to_camera * t).as_vec3();
        let walked = self.passing(first, begin, first.from_camera.0, Flaw::None);
        match flaw {
            Flaw::Points => None,
            Flaw::WalkedPoints => Some(1.0),
            _ => Some(density / walked),
        }
    }

    /// The rounding error that a weight may have.
    ///
    /// Each density in a weight is a product whose factors for a vertex have some roundings of 2⁻²⁴ each, and two that
    /// are amplified: a cosine has that error whatever its size, and a distance has the error of positions in a scene a
    /// few metres wide. A weight is off by no more than the products are. [Higham 2002, 3.1]
    pub(super) fn tolerance(&self) -> f64 {
        let inverse_cosine = |node: &PathVertex, to: Vec3| match node.at.is_in_medium() {
            true => 1.0,
            false => 1.0 / cosine(node.from_light.1, to, Flaw::None),
        };
        let cosines = self
            .nodes
            .iter()
            .map(|node| inverse_cosine(node, node.to_light) + inverse_cosine(node, node.to_camera));
        let lengths = self.nodes.windows(2).map(|pair| 4.0 / edge(&pair[0], &pair[1], Flaw::None).sqrt());
        // Each way along an edge has exponentials of rounded exponents, two sums of three channels and a ratio.
        let edges = if self.fog.is_some() { self.nodes.len() + 1 } else { 0 };
        // Where it begins and ends is rounded, too, and on a slant more.
        let per_edge = if self.fog.is_some_and(|fog| !fog.parts.is_empty()) { 400.0 } else { 2.0 * 8.0 };
        let roundings =
            8.0 * self.nodes.len() as f64 + per_edge * edges as f64 + cosines.chain(lengths).sum::<f64>();
        roundings / f64::from(1 << 24)
    }

    /// Densities of light subpaths of 0, 1, 2 … vertices.
    fn light_subpaths(&self, task: &Task, flaw: Flaw) -> Vec<f64> {
        let (scene, first) = (task.context.scene, &self.nodes[0]);
        let light = &scene.lights()[self.start.index].light;
        let direct = self.direct(task, first.from_light.0);
        let emission = light.emission_pdf(&scene.bounds(), direct as f32, -first.to_light, self.start.cos);
        let choice =
            if flaw == Flaw::LightChoice { 1.0 } else { task.context.emission.probability(self.start.index) };
        let lights = &task.context.lights;
        let chosen = match flaw {
            Flaw::Choice => 1.0,
            // By the end of the path that is not lit.
            Flaw::ChoiceElsewhere => {
                lights.probability(self.start.index, self.nodes[self.nodes.len() - 1].at.lit_at())
            }
            // Where the light subpath has come to, of two vertices that are merged.
            _ => lights.probability(self.start.index, first.at.lit_at().map(|_| first.from_light.0)),
        };
        let picked = direct * f64::from(chosen);
        let mut product = f64::from(emission)
            * f64::from(choice)
            * self.arriving(first, first.from_light.1, first.to_light, flaw);
        if let Some(p) = self.start.p {
            product *=
                self.passing(first, p, first.from_light.0, flaw) / distance2(p, first.from_light.0, flaw);
        }
        let mut all = vec![1.0, picked, product];
        for pair in self.nodes.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            product *= a.density(a.to_light, a.to_camera, TransportMode::Importance)
                * self.arriving(b, b.from_light.1, b.to_light, flaw)
                * self.passing(b, a.from_camera.0, b.from_light.0, flaw)
                / edge(a, b, flaw);
            all.push(product);
        }
        all
    }

    /// Densities of camera subpaths of 0, 1, 2 … vertices.
    fn camera_subpaths(&self, task: &Task, flaw: Flaw) -> Vec<f64> {
        let last = self.nodes.last().unwrap();
        let mut product = f64::from(self.camera_density)
            * self.arriving(last, last.from_camera.1, last.to_camera, Flaw::None);
        if self.fog.is_some() {
            let p = last.from_camera.0;
            let seen = task.context.camera.connect(p, Vec2::ZERO, last.at.time()).unwrap();
            product *= self.passing(last, seen.p, p, flaw);
        }
        let mut all = vec![1.0, 1.0, product];
        let mode = if flaw == Flaw::Reverse { TransportMode::Importance } else { TransportMode::Radiance };
        let density = |node: &PathVertex| {
            let [a, b] = if flaw == Flaw::Reverse {
                [node.to_light, node.to_camera]
            } else {
                [node.to_camera, node.to_light]
            };
            node.density(a, b, mode)
        };
        for pair in self.nodes.windows(2).rev() {
            let [b, a] = [&pair[0], &pair[1]];
            product *= density(a) * self.arriving(b, b.from_camera.1, b.to_camera, flaw) / edge(b, a, flaw);
            product *= self.passing(b, a.from_light.0, b.from_camera.0, flaw);
            all.push(product);
        }
        let light = &task.context.scene.lights()[self.start.index].light;
        let first = &self.nodes[0];
        product *= match self.start.p {
            _ if light.is_delta() => 0.0,
            None => density(first),
            Some(p) => {
                let survival = self.survival(p, first.from_light.0, flaw);
                density(first) * f64::from(self.start.cos) * survival / distance2(p, first.from_light.0, flaw)
            }
        };
        all.push(product);
        all
    }
}

impl Path {
    /// The cosine at a surface.
    fn arriving(&self, node: &PathVertex, n: Vec3, direction: Vec3, flaw: Flaw) -> f64 {
        if node.at.is_in_medium() { 1.0 } else { cosine(n, direction, flaw) }
    }

    /// The probability of coming to a surface from one point to the other through the fog, or the density per metre of an event there.
    fn passing(&self, node: &PathVertex, from: Vec3, to: Vec3, flaw: Flaw) -> f64 {
        match self.fog.filter(|_| node.at.is_in_medium()) {
            Some(fog) => f64::from(fog.extinction) * self.survival(from, to, Flaw::None),
            None => self.survival(from, to, flaw),
        }
    }

    /// Frequency with which two beams of one metre's width cross at a point of the fog, over the densities of both walks having
    /// events there.
    fn crossing(&self, node: &PathVertex, flaw: Flaw) -> f64 {
        let sine = match flaw {
            Flaw::Sine => 1.0,
            _ => node.to_light.as_dvec3().cross(node.to_camera.as_dvec3()).length(),
        };
        let extinction = || self.fog.map_or(1.0, |fog| f64::from(fog.extinction));
        let fog = if flaw == Flaw::Extinction { 1.0 } else { extinction() };
        sine / (fog * fog)
    }

    /// The volume in which a point of the fog, whose boundary is known or not, is merged with points; `None` where beams are.
    fn ball(&self, task: &Task, node: &PathVertex, techniques: &TechniqueCounts, flaw: Flaw) -> Option<f64> {
        let Interaction::Medium(MediumPoint { even: Some(extinction), .. }) = node.at else { return None };
        let densest = extinction.max_channel();
        if techniques.points == PerSet::ZERO || techniques.densest >= densest {
            return None;
        }
        let widest = if is_dense(task.context.scene) { 0.5 } else { 0.05 };
        let radius = f64::from(techniques.radius.min(widest / densest));
        let radius = if flaw == Flaw::Ball { 1.3 * radius } else { radius };
        Some(4.0 / 3.0 * PI * radius * radius * radius)
    }

    fn survival(&self, from: Vec3, to: Vec3, flaw: Flaw) -> f64 {
        let Some(fog) = self.fog.filter(|_| flaw != Flaw::Survival) else { return 1.0 };
        exp_f64(-f64::from(fog.extinction) * fog.between(from, to))
    }
}

impl PathVertex {
    /// Whether light passes it straight.
    fn is_pane(&self, task: &Task) -> bool {
        let is_straight = self.to_light.dot(self.to_camera) < -0.9999;
        self.is_delta && is_straight && passes_straight(task.context.scene, &self.at, self.to_camera)
    }

    fn density(&self, wo: Vec3, wi: Vec3, mode: TransportMode) -> f64 {
        if self.is_delta { 1.0 } else { f64::from(self.at.pdf_solid_angle(wo, wi, mode)) }
    }
}

fn cosine(n: Vec3, direction: Vec3, flaw: Flaw) -> f64 {
    if flaw == Flaw::Cosine { 1.0 } else { n.as_dvec3().dot(direction.as_dvec3()).abs() }
}

/// The squared distance from a vertex to the next one towards the camera.
fn edge(a: &PathVertex, b: &PathVertex, flaw: Flaw) -> f64 {
    distance2(a.from_camera.0, b.from_light.0, flaw)
}

fn distance2(a: Vec3, b: Vec3, flaw: Flaw) -> f64 {
    if flaw == Flaw::Distance { 1.0 } else { a.as_dvec3().distance_squared(b.as_dvec3()) }
}
