//! JPEG files whose components come in scans of their own, as some programs write them.

use bilux_pictures::{Limits, read_rgba8};

const SIZE: usize = 64;

/// Luma and chroma of the four quarters of the picture.
fn component(which: usize, left: bool, top: bool) -> i32 {
    let pick = |is: bool, a, b| if is { a } else { b };
    [pick(top, 100, 160), pick(left, 90, 170), pick(top, 200, 80)][which]
}

fn segment(marker: u8, body: &[u8]) -> Vec<u8> {
    let [high, low] = (body.len() as u16 + 2).to_be_bytes();
    [&[0xff, marker, high, low], body].concat()
}

/// The blocks of one component, each uniform: a difference to the last one, and the end of the block.
fn scan(values: &[i32]) -> Vec<u8> {
    let mut bits = String::new();
    let mut last = 0;
    for value in values {
        let difference = value - last;
        last = *value;
        let count = (32 - difference.unsigned_abs().leading_zeros()) as usize;
        let coded = if difference < 0 { difference + (1 << count) - 1 } else { difference };
        bits += &format!("{count:04b}");
        if count > 0 {
            bits += &format!("{coded:0count$b}");
        }
        bits += "0";
    }
    while !bits.len().is_multiple_of(8) {
        bits += "1";
    }
    let bytes = (0..bits.len() / 8).map(|i| u8::from_str_radix(&bits[8 * i..8 * i + 8], 2).unwrap());
    bytes.flat_map(|byte| [byte, 0].into_iter().take(if byte == 255 { 2 } else { 1 })).collect()
}

/// A baseline file with three scans, where luma has this many samples for each of chroma, along x and y.
fn in_three_scans([across, down]: [usize; 2]) -> Vec<u8> {
    let mut file = vec![0xff, 0xd8];
    file.extend(segment(0xdb, &[&[0][..], &[8; 64]].concat()));
    let luma = (across * 16 + down) as u8;
    file.extend(segment(0xc0, &[8, 0, SIZE as u8, 0, SIZE as u8, 3, 1, luma, 0, 2, 0x11, 0, 3, 0x11, 0]));
    // Twelve codes of four bits; and a single code of one bit, for the end of a block.
    let lengths = [&[0, 0, 0, 12][..], &[0; 12]].concat();
    file.extend(segment(0xc4, &[&[0][..], &lengths, &(0..12).collect::<Vec<u8>>()].concat()));
    file.extend(segment(0xc4, &[&[0x10, 1][..], &[0; 15], &[0]].concat()));
    for which in 0..3 {
        let [across, down] = if which == 0 { [1, 1] } else { [across, down] };
        let (columns, rows) = (SIZE / 8 / across, SIZE / 8 / down);
        let blocks = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let values = blocks.map(|(x, y)| component(which, 2 * x < columns, 2 * y < rows) - 128);
        file.extend(segment(0xda, &[1, which as u8 + 1, 0, 0, 63, 0]));
        file.extend(scan(&values.collect::<Vec<_>>()));
    }
    file.extend([0xff, 0xd9]);
    file
}

#[test]
fn components_in_scans_of_their_own_keep_their_colours() {
    for sampling in [[1, 1], [2, 1], [2, 2]] {
        let file = in_three_scans(sampling);
        let picture = read_rgba8(&file, Some("jpeg"), &Limits::default()).unwrap().unwrap();
        for (x, y) in (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y))) {
            // Chroma is interpolated across the borders of the quarters.
            if [x, y].iter().any(|c| c.abs_diff(SIZE / 2) < 4) {
                continue;
            }
            let [luma, cb, cr] =
                [0, 1, 2].map(|which| component(which, x < SIZE / 2, y < SIZE / 2) as f32 - 128.0);
            let luma = luma + 128.0;
            let rgb = [luma + 1.402 * cr, luma - 0.344 * cb - 0.714 * cr, luma + 1.772 * cb];
            let found = picture.texels[y * SIZE + x];
            for (wanted, found) in rgb.into_iter().zip(found) {
                let off = (wanted.clamp(0.0, 255.0) - f32::from(found)).abs();
                assert!(off < 3.0, "{sampling:?} at {x}, {y}: {found}, not {wanted}");
            }
        }
    }
}
