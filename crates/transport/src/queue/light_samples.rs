//! Samples of lights, one for each vertex.

use super::lanes::{Column, Columns3, LANES, Stage, ZERO3, put, run_at, vec3};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::CpuLevel;
use bilux_scene::lights::{
    ChosenPiece, CumulativePart, LightSample, LightTriangle, MeshLight, Piece, Receiver, Sides,
    TriangleSample, barycentric,
};
use bilux_scene::scene::SceneLight;

/// The samples.
pub(super) struct LightSamples {
    pub(super) wi: Columns3,
    pub(super) li: Columns3,
    /// Ends of the rays: the point on the light; `wi` for light from infinity.
    pub(super) towards: Columns3,
    pub(super) n_light: Columns3,
    /// 1 for light from infinity, otherwise 0.
    pub(super) is_infinite: Column,
    pub(super) clearance: Column,
    /// Density over solid angle times the probability of the light; 0 where there is no sample.
    pub(super) pdf: Column,
    /// 1 for delta lights, otherwise 0.
    pub(super) is_delta: Column,
    triangles: Triangles,
    receivers: Vec<Receiver>,
    samples: Vec<Option<LightSample>>,
}

/// The triangles of a mesh light on which the samples are, and all else that [`SampleTriangles`] needs.
struct Triangles {
    corners: [Columns3; 3],
    normal: Columns3,
    pdf_area: Column,
    /// The pieces of these triangles: where they begin, and their scale.
    pieces: Columns3,
    /// The points that receive the light.
    from: Columns3,
    /// The sampler's numbers; the first of each is what is left after a triangle was chosen.
    u: [Column; 2],
    /// Rest of the first number after it has picked a triangle, for lights of few.
    rest: Column,
    probability: f32,
    sides: Sides,
}

impl Triangles {
    /// The weights of a lane's point in its triangle.
    #[inline(always)]
    fn weights(&self, i: usize) -> [f32; 3] {
        let [x, y, scale] = vec3(&self.pieces, i).to_array();
        Piece { begin: Vec2::new(x, y), scale }
            .weights(barycentric(Vec2::new(self.u[0].0[i], self.u[1].0[i])))
    }
}

impl Default for LightSamples {
    fn default() -> LightSamples {
        LightSamples {
            wi: ZERO3,
            li: ZERO3,
            towards: ZERO3,
            n_light: ZERO3,
            is_infinite: Column::ZERO,
            clearance: Column::ZERO,
            pdf: Column::ZERO,
            is_delta: Column::ZERO,
            triangles: Triangles {
                corners: [ZERO3; 3],
                normal: ZERO3,
                pdf_area: Column::ZERO,
                pieces: ZERO3,
                from: ZERO3,
                u: [Column::ZERO; 2],
                rest: Column::ZERO,
                probability: 0.0,
                sides: Sides::Both,
            },
            receivers: Vec::with_capacity(LANES),
            samples: Vec::with_capacity(LANES),
        }
    }
}

/// The points that light falls on, and the sampler's numbers for each.
pub(super) struct Points<'a> {
    pub(super) count: usize,
    pub(super) times: &'a [f32; LANES],
    pub(super) p: &'a Columns3,
    pub(super) u: &'a mut [Column; 2],
}

impl LightSamples {
    /// Samples the light that was picked for each vertex, with its probability there; 0 where none was.
    pub(super) fn sample_lights(
        &mut self,
        points: Points,
        picked: &[(usize, f32); LANES],
        lights: &[SceneLight],
    ) {
        let Points { count, times, p, u } = points;
        self.receivers.clear();
        self.receivers.extend((0..count).map(|i| receiver(i, times, p, u)));
        let mut begin = 0;
        while begin < count {
            // Vertices in a row that sample the same light.
            let (number, _) = picked[begin];
            let is_drawn = picked[begin].1 > 0.0;
            let same =
                |(other, probability): &&(usize, f32)| *other == number && (*probability > 0.0) == is_drawn;
            let end = begin + picked[begin..count].iter().take_while(same).count();
            if !is_drawn {
                self.pdf.0[begin..end].fill(0.0);
                begin = end;
                continue;
            }
            let light = &lights[number].light;
            light.sample_li_each(&self.receivers[begin..end], &mut self.samples);
            for (i, &(_, probability)) in picked.iter().enumerate().take(end).skip(begin) {
                self.put(i, self.samples[i - begin], probability, light.is_delta());
            }
            begin = end;
        }
    }

    fn put(&mut self, i: usize, sample: Option<LightSample>, probability: f32, is_delta: bool) {
        let Some(sample) = sample else {
            self.pdf.0[i] = 0.0;
            return;
        };
        put(&mut self.wi, i, sample.wi.to_array());
        put(&mut self.li, i, sample.li.to_array());
        put(&mut self.towards, i, sample.point.unwrap_or(sample.wi).to_array());
        put(&mut self.n_light, i, sample.n_light.to_array());
        self.is_infinite.0[i] = if sample.point.is_none() { 1.0 } else { 0.0 };
        self.clearance.0[i] = sample.clearance;
        self.pdf.0[i] = sample.pdf_solid_angle * probability;
        self.is_delta.0[i] = if is_delta { 1.0 } else { 0.0 };
    }

    /// Samples the same mesh light for every vertex.
    pub(super) fn sample_mesh(
        &mut self,
        points: Points,
        mesh: &MeshLight,
        probability: f32,
        level: CpuLevel,
    ) {
        let (samples, Points { count, times, p, u }) = (self, points);
        (samples.is_infinite, samples.is_delta) = (Column::ZERO, Column::ZERO);
        (samples.triangles.probability, samples.triangles.sides) = (probability, mesh.sides());
        (samples.triangles.from, samples.triangles.u) = (*p, *u);
        if let Some(few) = mesh.few_even_triangles() {
            for triangle in few {
                run_at(level, Pick { samples, triangle: &triangle });
            }
            samples.triangles.u[0] = samples.triangles.rest;
            samples.triangles.pieces = WHOLE;
            run_at(level, SampleTriangles { samples });
            run_at(level, Emit { samples, radiance: &mesh.radiance(0, [0.0; 3]) });
            return;
        }
        let mut chosen_triangles = [0; LANES];
        samples.receivers.clear();
        samples.receivers.extend((0..count).map(|i| receiver(i, times, p, u)));
        mesh.choose_each(samples.receivers.iter().copied(), |i, chosen| {
            // No triangle shines here, unless one is chosen.
            samples.triangles.pdf_area.0[i] = 0.0;
            let Some(ChosenPiece { triangle, piece, rest, facet, .. }) = chosen else { return };
            (chosen_triangles[i], u[0].0[i]) = (triangle, rest);
            let LightTriangle { corners, normal, pdf_area } = facet;
            for (columns, corner) in samples.triangles.corners.iter_mut().zip(corners) {
                put(columns, i, corner.to_array());
            }
            put(&mut samples.triangles.normal, i, normal.to_array());
            samples.triangles.pdf_area.0[i] = pdf_area;
            put(&mut samples.triangles.pieces, i, [piece.begin.x, piece.begin.y, piece.scale]);
        });
        samples.triangles.u[0] = u[0];
        run_at(level, SampleTriangles { samples });
        for (i, &triangle) in chosen_triangles.iter().enumerate().take(count) {
            let is_there = samples.pdf.0[i] > 0.0;
            let weights = || samples.triangles.weights(i);
            let li = if is_there { mesh.radiance(triangle, weights()) } else { Rgb::BLACK };
            put(&mut samples.li, i, li.to_array());
        }
    }
}

/// The whole triangle, in every lane.
const WHOLE: Columns3 = {
    let Piece { begin, scale } = Piece::WHOLE;
    [Column([begin.x; LANES]), Column([begin.y; LANES]), Column([scale; LANES])]
};

/// The point of a lane that light falls on.
#[inline]
fn receiver(i: usize, times: &[f32; LANES], p: &Columns3, u: &[Column; 2]) -> Receiver {
    Receiver { p: vec3(p, i), time: times[i], u: Vec2::new(u[0].0[i], u[1].0[i]) }
}

/// Gives a triangle to the lanes whose number picks it or one after it.
struct Pick<'a> {
    samples: &'a mut LightSamples,
    triangle: &'a (LightTriangle, CumulativePart),
}

impl Stage for Pick<'_> {
    #[inline(always)]
    fn run(self) {
        let Triangles { corners, normal, pdf_area, u, rest, .. } = &mut self.samples.triangles;
        let (triangle, part) = *self.triangle;
        for i in 0..LANES {
            let picks = part.begin <= u[0].0[i];
            let of = |new: f32, old: f32| if picks { new } else { old };
            for (columns, corner) in corners.iter_mut().zip(triangle.corners) {
                for (column, c) in columns.iter_mut().zip(corner.to_array()) {
                    column.0[i] = of(c, column.0[i]);
                }
            }
            for (column, c) in normal.iter_mut().zip(triangle.normal.to_array()) {
                column.0[i] = of(c, column.0[i]);
            }
            pdf_area.0[i] = of(triangle.pdf_area, pdf_area.0[i]);
            rest.0[i] = of(part.rest(u[0].0[i]), rest.0[i]);
        }
    }
}

/// The light of the samples, where a light emits evenly.
struct Emit<'a> {
    samples: &'a mut LightSamples,
    radiance: &'a Rgb,
}

impl Stage for Emit<'_> {
    #[inline(always)]
    fn run(self) {
        let LightSamples { li, pdf, .. } = self.samples;
        let radiance = *self.radiance;
        for i in 0..LANES {
            let of = |c: f32| if pdf.0[i] > 0.0 { c } else { 0.0 };
            put(li, i, [of(radiance.r), of(radiance.g), of(radiance.b)]);
        }
    }
}

/// Points on the triangles.
struct SampleTriangles<'a> {
    samples: &'a mut LightSamples,
}

impl Stage for SampleTriangles<'_> {
    #[inline(always)]
    fn run(self) {
        let LightSamples { wi, towards, n_light, clearance, pdf, triangles, .. } = self.samples;
        let (probability, sides) = (triangles.probability, triangles.sides);
        for i in 0..LANES {
            let [a, b, c] = &triangles.corners;
            let corners: [Vec3; 3] = [vec3(a, i), vec3(b, i), vec3(c, i)];
            let normal = vec3(&triangles.normal, i);
            let triangle = LightTriangle { corners, normal, pdf_area: triangles.pdf_area.0[i] };
            let weights = triangles.weights(i);
            let sample = TriangleSample::new(vec3(&triangles.from, i), &triangle, weights, sides);
            put(wi, i, sample.wi.to_array());
            put(towards, i, sample.point.to_array());
            put(n_light, i, sample.n_light.to_array());
            clearance.0[i] = sample.clearance;
            pdf.0[i] = sample.pdf_solid_angle * probability;
        }
    }
}
