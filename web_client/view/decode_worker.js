// Decodes images off the main thread: receives {id, bytes, type}, sends {id, bitmap}; bitmap is
// null if the image is broken. The receiver owns the bitmap.
self.onmessage = async (event) => {
  const { id, bytes, type } = event.data;
  try {
    const bitmap = await createImageBitmap(new Blob([bytes], { type }));
    self.postMessage({ id, bitmap }, { transfer: [bitmap] });
  } catch {
    self.postMessage({ id, bitmap: null });
  }
};
