//! Accessors: typed elements in buffers. They cover every component type, normalised or not, interleaved or
//! sparse.

use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// A list of elements that is known to lie within its buffer.
pub(crate) struct Accessor<'d> {
    pub(crate) node: JsonNode<'d>,
    pub(crate) count: usize,
    component: Component,
    shape: Shape,
    is_normalised: bool,
    /// `None` if all elements are zero except the sparse ones.
    data: Option<Strided<'d>>,
    sparse: Option<Sparse<'d>>,
}

/// The component type.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

/// The number of components of an element, in columns.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape {
    columns: usize,
    rows: usize,
}

/// Elements at a constant stride, the first one at the first byte.
#[derive(Clone, Copy)]
struct Strided<'d> {
    bytes: &'d [u8],
    stride: usize,
}

/// Elements that replace others.
struct Sparse<'d> {
    indices: Vec<u32>,
    values: Strided<'d>,
}

const SHAPES: [(&str, Shape); 7] = [
    ("SCALAR", Shape { columns: 1, rows: 1 }),
    ("VEC2", Shape { columns: 1, rows: 2 }),
    ("VEC3", Shape { columns: 1, rows: 3 }),
    ("VEC4", Shape { columns: 1, rows: 4 }),
    ("MAT2", Shape { columns: 2, rows: 2 }),
    ("MAT3", Shape { columns: 3, rows: 3 }),
    ("MAT4", Shape { columns: 4, rows: 4 }),
];

impl<'d> Accessor<'d> {
    /// The accessor that `index` names.
    pub(crate) fn named(
        document: &'d Document<'d>,
        index: JsonNode<'d>,
        budget: &mut Budget,
    ) -> Result<Accessor<'d>, FormatError> {
        Accessor::open(document, index.as_count()?, document.named("accessors", index)?, budget)
    }

    pub(crate) fn open(
        document: &'d Document<'d>,
        number: usize,
        node: JsonNode<'d>,
        budget: &mut Budget,
    ) -> Result<Accessor<'d>, FormatError> {
        let count = node.need("count")?.as_count()?;
        let component = Component::read(node.need("componentType")?)?;
        let kind = node.need("type")?;
        let name = kind.as_text()?;
        let Some((_, shape)) = SHAPES.iter().find(|(known, _)| *known == name) else {
            let known = SHAPES.map(|(name, _)| name).join(", ");
            return Err(kind.error(format!("'{name}' is not an element type; known are {known}")));
        };
        let mut accessor = Accessor {
            node,
            count,
            component,
            shape: *shape,
            is_normalised: node.switch("normalized")?,
            data: None,
            sparse: None,
        };
        let offset = node.count("byteOffset")?.unwrap_or(0);
        let size = accessor.element_size();
        if let Some(drawn) = document.drawn(number) {
            if drawn.count != count || drawn.bytes.len() != count.saturating_mul(size) {
                let (have, bytes) = (drawn.count, drawn.bytes.len());
                let message =
                    format!("{have} elements of {bytes} bytes are compressed for these {count} of {size}");
                return Err(node.error(message));
            }
            accessor.data = Some(Strided { bytes: &drawn.bytes, stride: size });
        } else if let Some(view) = node.get("bufferView") {
            accessor.data = Some(strided(document, node, view, [offset, count, size])?);
        } else if count > document.size() {
            let message =
                format!("{count} elements without data are more than a file of this size can plausibly have");
            return Err(node.error(message));
        }
        if let Some(sparse) = node.get("sparse") {
            accessor.sparse = Some(Sparse::read(document, sparse, count, size, budget)?);
        }
        Ok(accessor)
    }

    /// Makes integers fractions of the greatest one; false if they were already, or are no integers.
    pub(crate) fn normalise(&mut self) -> bool {
        let changes = self.component != Component::F32 && !self.is_normalised;
        self.is_normalised |= changes;
        changes
    }

    /// The elements as arrays of exactly `N` numbers.
    pub(crate) fn floats<const N: usize>(&self, budget: &mut Budget) -> Result<Vec<[f32; N]>, FormatError> {
        if self.width() != N {
            let have = self.width();
            return Err(self
                .node
                .error(format!("its elements have {have} numbers, but {N} are needed here")));
        }
        budget.take_bytes((self.count as u64).saturating_mul(4 * N as u64), &self.node.at().file)?;
        let mut all = vec![[0.0; N]; self.count];
        if let Some(data) = self.data.filter(|_| self.component == Component::F32 && self.shape.columns == 1)
        {
            // By far the most common case, without a branch in the loop.
            for (element, bytes) in all.iter_mut().zip(data.bytes.chunks(data.stride)) {
                let numbers = bytes[..4 * N].chunks_exact(4);
                element
                    .iter_mut()
                    .zip(numbers)
                    .for_each(|(x, b)| *x = f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            }
        } else if let Some(data) = self.data {
            all.iter_mut().enumerate().for_each(|(i, element)| self.read(data, i, element));
        }
        if let Some(sparse) = &self.sparse {
            for (i, &index) in sparse.indices.iter().enumerate() {
                self.read(sparse.values, i, &mut all[index as usize]);
            }
        }
        Ok(all)
    }

    /// All numbers of all elements, in order.
    pub(crate) fn numbers(&self, budget: &mut Budget) -> Result<Vec<f32>, FormatError> {
        let width = self.width();
        let total = self.count.saturating_mul(width);
        budget.take_bytes((total as u64).saturating_mul(4), &self.node.at().file)?;
        let mut all = vec![0.0; total];
        if let Some(data) = self.data {
            all.chunks_exact_mut(width).enumerate().for_each(|(i, element)| self.read(data, i, element));
        }
        if let Some(sparse) = &self.sparse {
            for (i, &index) in sparse.indices.iter().enumerate() {
                self.read(sparse.values, i, &mut all[index as usize * width..][..width]);
            }
        }
        Ok(all)
    }

    /// The elements as whole numbers, such as indices.
    pub(crate) fn indices(&self, budget: &mut Budget) -> Result<Vec<u32>, FormatError> {
        if self.width() != 1 || !matches!(self.component, Component::U8 | Component::U16 | Component::U32) {
            return Err(self.node.error("indices must be SCALAR, unsigned, of 8, 16 or 32 bits"));
        }
        budget.take_bytes((self.count as u64).saturating_mul(4), &self.node.at().file)?;
        let mut all = vec![0; self.count];
        let read = |from: Strided, i: usize| self.component.whole(&from.bytes[i * from.stride..]);
        if let Some(data) = self.data.filter(|data| self.component == Component::U32 && data.stride == 4) {
            let numbers = data.bytes.chunks_exact(4);
            all.iter_mut().zip(numbers).for_each(|(x, b)| *x = u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        } else if let Some(data) = self.data {
            all.iter_mut().enumerate().for_each(|(i, slot)| *slot = read(data, i));
        }
        if let Some(sparse) = &self.sparse {
            for (i, &index) in sparse.indices.iter().enumerate() {
                all[index as usize] = read(sparse.values, i);
            }
        }
        Ok(all)
    }

    /// True if elements begin at multiples of their component size, within the view and within the buffer.
    pub(crate) fn is_aligned(&self, document: &'d Document<'d>) -> Result<bool, FormatError> {
        let Some(view) = self.node.get("bufferView") else { return Ok(true) };
        let view = document.named("bufferViews", view)?;
        let offset = |node: JsonNode<'d>| Ok::<_, FormatError>(node.count("byteOffset")?.unwrap_or(0));
        let (inside, outside) = (offset(self.node)?, offset(view)?);
        let size = self.component.size();
        let is_matrix = self.shape.columns > 1;
        Ok(inside % size == 0 && (inside + outside) % size == 0 && !(is_matrix && inside % 4 != 0))
    }

    /// The number of components of an element.
    pub(crate) fn width(&self) -> usize {
        self.shape.columns * self.shape.rows
    }

    #[inline]
    fn read(&self, from: Strided, index: usize, element: &mut [f32]) {
        let bytes = &from.bytes[index * from.stride..];
        let (size, rows) = (self.component.size(), self.shape.rows);
        let column = self.column_size();
        for (i, number) in element.iter_mut().enumerate() {
            let at = i / rows * column + i % rows * size;
            *number = self.component.number(&bytes[at..], self.is_normalised);
        }
    }

    /// Bytes from one column to the next: matrix columns begin at multiples of 4.
    fn column_size(&self) -> usize {
        let bytes = self.shape.rows * self.component.size();
        if self.shape.columns > 1 { bytes.next_multiple_of(4) } else { bytes }
    }

    fn element_size(&self) -> usize {
        self.column_size() * self.shape.columns
    }
}

/// Elements within a view, or else an error at the node that claims they are there.
fn strided<'d>(
    document: &'d Document<'d>,
    node: JsonNode<'d>,
    view: JsonNode<'d>,
    [offset, count, size]: [usize; 3],
) -> Result<Strided<'d>, FormatError> {
    let view = document.view(view)?;
    let stride = view.stride.unwrap_or(size);
    if stride < size {
        return Err(
            node.error(format!("elements of {size} bytes are only {stride} bytes apart (byteStride)"))
        );
    }
    let last = count.saturating_sub(1).checked_mul(stride);
    let end = last.and_then(|last| last.checked_add(offset)?.checked_add(if count == 0 { 0 } else { size }));
    if end.is_none_or(|end| end > view.bytes.len()) {
        let have = view.bytes.len();
        let message = format!(
            "{count} elements, {stride} bytes apart, from byte {offset} extend beyond the buffer view, which has \
             {have} bytes"
        );
        return Err(node.error(message));
    }
    Ok(Strided { bytes: &view.bytes[offset..], stride })
}

impl<'d> Sparse<'d> {
    fn read(
        document: &'d Document<'d>,
        node: JsonNode<'d>,
        total: usize,
        size: usize,
        budget: &mut Budget,
    ) -> Result<Sparse<'d>, FormatError> {
        let count = node.need("count")?.as_count()?;
        if count > total {
            return Err(node.error(format!("{count} sparse elements cannot replace {total}")));
        }
        let (places, values) = (node.need("indices")?, node.need("values")?);
        let component = Component::read(places.need("componentType")?)?;
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(places.error("sparse indices must be unsigned, of 8, 16 or 32 bits"));
        }
        let offset = |node: JsonNode<'d>| Ok::<_, FormatError>(node.count("byteOffset")?.unwrap_or(0));
        let from = strided(
            document,
            places,
            places.need("bufferView")?,
            [offset(places)?, count, component.size()],
        )?;
        budget.take_bytes(count as u64 * 4, &node.at().file)?;
        let read = |i: usize| component.whole(&from.bytes[i * from.stride..]);
        let indices: Vec<u32> = (0..count).map(read).collect();
        let rises = indices.windows(2).all(|pair| pair[0] < pair[1]);
        if !rises || indices.last().is_some_and(|&last| last as usize >= total) {
            return Err(places.error(format!("sparse indices must increase and be less than {total}")));
        }
        let values = strided(document, values, values.need("bufferView")?, [offset(values)?, count, size])?;
        Ok(Sparse { indices, values })
    }
}

impl Component {
    fn read(node: JsonNode) -> Result<Component, FormatError> {
        Ok(match node.as_count()? {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            other => {
                return Err(
                    node.error(format!("{other} is not a componentType: use 5120 to 5123, 5125 or 5126"))
                );
            }
        })
    }

    fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// The number at the start of the bytes. Normalised ones range from 0 or -1 to 1. [glTF 2.0, 3.6.2.2]
    #[inline]
    fn number(self, bytes: &[u8], is_normalised: bool) -> f32 {
        let (x, greatest) = match self {
            Component::F32 => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
            Component::I8 => (f32::from(bytes[0] as i8), 127.0),
            Component::U8 => (f32::from(bytes[0]), 255.0),
            Component::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
            Component::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
            Component::U32 => (self.whole(bytes) as f32, u32::MAX as f32),
        };
        if is_normalised { (x / greatest).max(-1.0) } else { x }
    }

    #[inline]
    fn whole(self, bytes: &[u8]) -> u32 {
        match self {
            Component::I8 | Component::U8 => u32::from(bytes[0]),
            Component::I16 | Component::U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            Component::U32 | Component::F32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}
