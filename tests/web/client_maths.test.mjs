// Proves the client's maths without a browser: projection against values worked out by hand and
// against its own inverse, rotations against known ones, node placements against their inverse, the
// camera's movements by what must stay constant, and the size of the image.
import assert from 'node:assert/strict';
import { test } from 'node:test';

import {
  mapDirection,
  multiply,
  parentFromNode,
  mapPoint,
  unmapDirection,
} from '../../web_client/math/affine.js';
import { linearFromSrgb, srgbFromLinear } from '../../web_client/math/color.js';
import {
  closestOnAxis,
  meetPlane,
  projectPoint,
  rayThrough,
} from '../../web_client/math/projection.js';
import { fromEulerDegrees, rotate, toEulerDegrees } from '../../web_client/math/quaternion.js';
import { add, length, scale, subtract } from '../../web_client/math/vector.js';
import { Camera } from '../../web_client/view/camera.js';
import { chooseViewSize } from '../../web_client/view/view_size.js';

function near(actual, expected, tolerance = 1e-9) {
  const a = [actual].flat();
  const b = [expected].flat();
  assert.equal(a.length, b.length);
  a.forEach((value, i) =>
    assert.ok(
      Math.abs(value - b[i]) <= tolerance,
      `${JSON.stringify(a)} is not ${JSON.stringify(b)}`,
    ),
  );
}

const POSE = { eye: [0, 0, 5], target: [0, 0, 0], up: [0, 1, 0], fov_y_rad: Math.PI / 2 };
const TILTED = { eye: [3, 4, -2], target: [-1, 0.5, 2], up: [0, 1, 0], fov_y_rad: 0.8 };

test('projects points to where they are seen', () => {
  // At 5 m, a field of view of 90 degrees is 10 m high and, at 2:1, 20 m wide.
  const middle = projectPoint(POSE, 2, [0, 0, 0]);
  near([middle.x, middle.y, middle.depth], [0.5, 0.5, 5]);
  const corner = projectPoint(POSE, 2, [10, 5, 0]);
  near([corner.x, corner.y], [1, 0]);
  assert.equal(projectPoint(POSE, 2, [0, 0, 6]), null, 'behind the eye');
});

test('a ray through a projected point meets it', () => {
  for (const point of [[0, 0, 0], [-2, 1, 1], [0.3, -1, 3]]) {
    const position = projectPoint(TILTED, 16 / 9, point);
    const ray = rayThrough(TILTED, 16 / 9, position.x, position.y);
    const reach = length(subtract(point, TILTED.eye));
    near(add(ray.origin, scale(ray.direction, reach)), point, 1e-9);
  }
});

test('drags along an axis and in a plane', () => {
  const ray = rayThrough(TILTED, 1, 0.4, 0.6);
  const along = closestOnAxis(ray, [1, 0, 0], [0, 1, 0]);
  const point = [1, along, 0];
  const reach = length(subtract(point, ray.origin));
  // Points of the axis next to the closest one are farther from the ray.
  const distance = (p) => {
    const offset = subtract(p, ray.origin);
    const t =
      offset[0] * ray.direction[0] + offset[1] * ray.direction[1] + offset[2] * ray.direction[2];
    return length(subtract(offset, scale(ray.direction, t)));
  };
  assert.ok(reach > 0);
  assert.ok(distance(point) < distance([1, along + 0.01, 0]));
  assert.ok(distance(point) < distance([1, along - 0.01, 0]));
  assert.equal(
    closestOnAxis({ origin: [0, 0, 5], direction: [0, 0, -1] }, [0, 0, 0], [0, 0, 1]),
    null,
  );
  near(meetPlane({ origin: [1, 2, 5], direction: [0, 0, -1] }, [0, 0, 1], [0, 0, 1]), [1, 2, 1]);
});

test('turns by quaternions and back', () => {
  near(rotate(fromEulerDegrees([0, 0, 90]), [1, 0, 0]), [0, 1, 0]);
  near(rotate(fromEulerDegrees([90, 0, 0]), [0, 1, 0]), [0, 0, 1]);
  near(rotate(fromEulerDegrees([0, 90, 0]), [0, 0, 1]), [1, 0, 0]);
  near(toEulerDegrees(fromEulerDegrees([20, -35, 130])), [20, -35, 130], 1e-9);
  near(toEulerDegrees([0, 1, 0, 0]), [0, 180, 0], 1e-9);
  const far = fromEulerDegrees([170, 60, -160]);
  near(rotate(fromEulerDegrees(toEulerDegrees(far)), [1, 2, 3]), rotate(far, [1, 2, 3]), 1e-9);
  // Straight along Y the three angles are not unique, but the rotation is.
  for (const angles of [[30, 90, 0], [10, -90, 25]]) {
    const there = fromEulerDegrees(angles);
    const back = fromEulerDegrees(toEulerDegrees(there));
    near(rotate(back, [1, 2, 3]), rotate(there, [1, 2, 3]), 1e-6);
  }
});

test('places nodes below turned and stretched parents', () => {
  const parent = parentFromNode({
    translation: [1, 0, 0],
    rotation: fromEulerDegrees([0, 0, 90]),
    scale: [2, 3, 4],
  });
  const child = parentFromNode({
    translation: [1, 0, 0],
    rotation: [0, 0, 0, 1],
    scale: [1, 1, 1],
  });
  near(multiply(parent, child)[3], [1, 2, 0]);
  near(mapPoint(parent, [0, 1, 0]), [-2, 0, 0]);
  near(unmapDirection(parent, mapDirection(parent, [0.3, -2, 5])), [0.3, -2, 5]);
  assert.equal(
    unmapDirection(
      [
        [1, 0, 0],
        [0, 0, 0],
        [0, 0, 1],
        [0, 0, 0],
      ],
      [1, 1, 1],
    ),
    null,
    'flat',
  );
});

test('converts colours both ways', () => {
  near(srgbFromLinear(0.2140411), 0.5, 1e-6);
  for (const value of [0, 0.001, 0.2, 1]) near(linearFromSrgb(srgbFromLinear(value)), value, 1e-9);
});

test('orbit keeps the target and the distance, look keeps the eye', () => {
  const camera = new Camera();
  camera.set(TILTED);
  const distance = camera.distance;
  camera.orbit(0.7, -0.2);
  near(camera.pose.target, TILTED.target);
  near(camera.distance, distance);
  const { eye } = camera.pose;
  camera.look(-0.3, 0.1);
  near(camera.pose.eye, eye);
  near(camera.distance, distance);
});

test('orbit does not tip over the pole', () => {
  const camera = new Camera();
  camera.orbit(0, -10);
  assert.ok(camera.pose.eye[1] > 4.9, 'the eye is above');
  assert.ok(Math.abs(camera.pose.eye[2]) > 1e-3, 'and not quite at the pole');
});

test('pan follows the hand', () => {
  const camera = new Camera();
  camera.set(POSE);
  const point = [0.4, 0.3, 0];
  const before = projectPoint(camera.pose, 1, point);
  camera.pan(0.1, -0.05);
  const after = projectPoint(camera.pose, 1, point);
  near([after.x - before.x, after.y - before.y], [0.1, -0.05], 1e-9);
});

test('framing shows all of a ball', () => {
  const camera = new Camera();
  camera.set(TILTED);
  for (const aspect of [0.5, 1, 2]) {
    camera.frame([1, 2, 3], 2, aspect);
    const { eye, target } = camera.pose;
    const ahead = subtract(target, eye);
    const side = [-ahead[2], 0, ahead[0]];
    const edge = add(target, scale(side, 1.99 / length(side)));
    const position = projectPoint(camera.pose, aspect, edge);
    assert.ok(position.x > 0 && position.x < 1, `aspect ${aspect}: ${position.x}`);
  }
});

test('the image keeps the shape of its stage within all limits', () => {
  const server = { isSoftware: false, maxWidth: 3840, maxHeight: 2160 };
  assert.deepEqual(chooseViewSize({ width: 800, height: 600 }, 1, 'auto', server), {
    width: 800,
    height: 600,
  });
  const large = chooseViewSize({ width: 2000, height: 1000 }, 2, '1280 × 720', server);
  assert.ok(large.width * large.height <= 1280 * 720 * 1.01);
  assert.ok(Math.abs(large.width / large.height - 2) < 0.01);
  const slow = chooseViewSize({ width: 1600, height: 900 }, 1, 'auto', {
    ...server,
    isSoftware: true,
  });
  assert.deepEqual(slow, { width: 640, height: 360 });
  const narrow = chooseViewSize({ width: 10, height: 4000 }, 1, '1920 × 1080', server);
  assert.ok(narrow.height <= 2160 && narrow.width >= 2);
});
