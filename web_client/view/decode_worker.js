// Decodes JPEGs off the main thread: receives {id, jpeg}, sends {id, bitmap}; bitmap is null if the
// JPEG is broken. The receiver owns the bitmap.
self.onmessage = async (event) => {
  const { id, jpeg } = event.data;
  try {
    const bitmap = await createImageBitmap(new Blob([jpeg], { type: 'image/jpeg' }));
    self.postMessage({ id, bitmap }, { transfer: [bitmap] });
  } catch {
    self.postMessage({ id, bitmap: null });
  }
};
