const KEEP = 512;

/**
 * Sends the camera to the server, at most once per animation frame, and remembers the poses, so
 * that what is drawn over an image can use the camera that the image was drawn with.
 */
export class CameraSender {
  /**
   * @param {import('../net/connection.js').Connection} connection
   * @param {import('./camera.js').Camera} camera
   */
  constructor(connection, camera) {
    this.connection = connection;
    this.camera = camera;
    this.revision = 0;
    /** @type {Map<number, import('../math/projection.js').CameraPose>} */
    this.poses = new Map();
    this.isThrottled = false;
    this.isChanged = false;
    camera.addEventListener('changed', () => this.#changed());
  }

  /** The pose of the frames that carry a camera revision. @param {number} revision */
  poseOf(revision) {
    return this.poses.get(revision) ?? this.camera.pose;
  }

  /** Takes a pose that the server chose itself: frames show it under the revision of before. */
  adopt(/** @type {import('../math/projection.js').CameraPose} */ pose) {
    this.poses.clear();
    this.camera.set(pose);
  }

  #changed() {
    this.isChanged = true;
    if (!this.isThrottled) this.#sendAndThrottle();
  }

  #sendAndThrottle() {
    this.isChanged = false;
    this.#send();
    this.isThrottled = true;
    requestAnimationFrame(() => {
      this.isThrottled = false;
      if (this.isChanged) this.#sendAndThrottle();
    });
  }

  #send() {
    const { pose } = this.camera;
    const revision = ++this.revision;
    this.poses.set(revision, pose);
    if (this.poses.size > KEEP) this.poses.delete(this.poses.keys().next().value ?? 0);
    // The next pose makes up for a lost or refused one.
    this.connection.call('camera.set', { ...pose, revision }).catch(() => {});
  }
}
