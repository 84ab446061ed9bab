//! Arbitrary bytes as a mesh and rays, on which every structure must agree.
#![allow(unreachable_pub)] // Shared by tests and the fuzzer.

use bilux_accel::registry::Quality;
use bilux_accel::{
    ACCELERATORS, Accelerator, BuildOptions, CpuLevel, Culling, Hit, Primitive, Query, Ray, TriangleMesh,
    build,
};
use std::sync::Arc;

/// Reads numbers until the bytes end.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn next(&mut self) -> Option<u8> {
        let (&first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(first)
    }

    /// On a small lattice, near one of its points, or arbitrary bits.
    fn number(&mut self) -> Option<f32> {
        let kind = self.next()?;
        let lattice = f32::from(kind & 15) - 8.0;
        Some(match kind >> 4 {
            0..8 => lattice,
            8..11 => {
                f32::from_bits(lattice.to_bits().wrapping_add(u32::from(self.next()?)).wrapping_sub(128))
            }
            11..13 => lattice * f32::from(self.next()?) / 255.0,
            13 => lattice * 1e-38,
            14 => lattice * 1e37,
            _ => f32::from_bits(u32::from_le_bytes([self.next()?, self.next()?, self.next()?, self.next()?])),
        })
    }

    fn vector(&mut self) -> Option<[f32; 3]> {
        Some([self.number()?, self.number()?, self.number()?])
    }

    fn triangle(&mut self) -> Option<[[f32; 3]; 3]> {
        Some([self.vector()?, self.vector()?, self.vector()?])
    }

    fn ray(&mut self) -> Option<Ray> {
        let ray = Ray::new(self.vector()?, self.vector()?);
        Some(match self.next()? & 3 {
            0 => Ray { t_min: self.number()?, ..ray },
            1 => Ray { t_max: self.number()?, ..ray },
            2 => Ray { exclude: Primitive { instance: 0, index: u32::from(self.next()?) }, ..ray },
            _ => ray,
        })
    }
}

/// Every structure, builder and CPU level.
fn structures(mesh: &Arc<TriangleMesh>) -> Vec<(String, Box<dyn Accelerator>)> {
    let mut all = Vec::new();
    for row in ACCELERATORS {
        for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
            for cpu_level in CpuLevel::ALL.into_iter().filter(|&level| level <= CpuLevel::detect()) {
                let options = BuildOptions { quality, cpu_level, ..BuildOptions::default() };
                let built = build(row.entry.name, Arc::clone(mesh), &options).expect("a small mesh");
                all.push((format!("{} {quality:?} {cpu_level:?}", row.entry.name), built));
                if !["brute-simd", "bvh8", "bvh8-compact"].contains(&row.entry.name) {
                    break;
                }
            }
            if !["bvh8", "bvh8-compact", "bsp-sah"].contains(&row.entry.name) {
                break;
            }
        }
    }
    all
}

fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive])
}

/// Panics when two structures do not agree. Returns how many rays hit something.
pub fn agree(bytes: &[u8]) -> usize {
    let mut bytes = Bytes(bytes);
    let count = usize::from(bytes.next().unwrap_or(0) % 48);
    let triangles: Vec<_> = std::iter::from_fn(|| bytes.triangle()).take(count).collect();
    let rays: Vec<Ray> = std::iter::from_fn(|| bytes.ray()).take(64).collect();
    let mesh = Arc::new(TriangleMesh::from_corners(triangles).expect("few triangles"));
    let brute = build("brute", Arc::clone(&mesh), &BuildOptions::default()).expect("a loop");
    let structures = structures(&mesh);
    let mut found = 0;
    for query in [Query::default(), Query { culling: Culling::Back, ..Query::default() }] {
        let truth: Vec<_> = rays.iter().map(|ray| bits(brute.closest_hit(ray, &query))).collect();
        found += truth.iter().flatten().count();
        for (name, structure) in &structures {
            let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
            structure.closest_hits(&rays, &query, &mut hits);
            structure.any_hits(&rays, &query, &mut any);
            for (((ray, truth), hit), any) in rays.iter().zip(&truth).zip(hits).zip(any) {
                assert_eq!(bits(structure.closest_hit(ray, &query)), *truth, "{name}: {ray:?}");
                assert_eq!(bits(hit), *truth, "{name}, in a batch: {ray:?}");
                assert_eq!(structure.any_hit(ray, &query), truth.is_some(), "{name}, any: {ray:?}");
                assert_eq!(any, truth.is_some(), "{name}, any in a batch: {ray:?}");
            }
        }
    }
    found
}
