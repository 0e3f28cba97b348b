#include <cmath>

#include "renderer/import/obj_import.hpp"

struct point2 {
    double x, y;
};

static double cross(const point2 &a, const point2 &b, const point2 &c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Projects along the largest axis of Newell's normal, so that the polygon runs counter-clockwise.
static std::vector<point2> project(const std::vector<const float *> &corners)
{
    double normal[3] = {};
    size_t count = corners.size();
    for (size_t i = 0; i < count; i++) {
        const float *a = corners[i];
        const float *b = corners[(i + 1) % count];
        for (int axis = 0; axis < 3; axis++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            normal[axis] += ((double)a[u] - b[u]) * ((double)a[v] + b[v]);
        }
    }
    int axis = std::fabs(normal[1]) > std::fabs(normal[0]) ? 1 : 0;
    axis = std::fabs(normal[2]) > std::fabs(normal[axis]) ? 2 : axis;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double sign = normal[axis] < 0 ? -1 : 1;
    std::vector<point2> points(count);
    for (size_t i = 0; i < count; i++) {
        points[i] = {corners[i][u], corners[i][v] * sign};
    }
    return points;
}

class ear_clipper
{
  public:
    explicit ear_clipper(const std::vector<const float *> &corners)
        : points(project(corners)), next(corners.size()), previous(corners.size())
    {
        uint32_t count = (uint32_t)corners.size();
        for (uint32_t i = 0; i < count; i++) {
            next[i] = (i + 1) % count;
            previous[i] = (i + count - 1) % count;
        }
        for (uint32_t i = 0; i < count; i++) {
            if (turn(i) < 0) {
                reflex.push_back(i);
            }
        }
    }

    void run(std::vector<uint32_t> &out)
    {
        uint32_t left = (uint32_t)points.size();
        uint32_t at = 0;
        uint32_t seen = 0; // corners checked since the last ear
        while (left > 3) {
            // A polygon that is not simple may have no ear left: then clips any corner.
            if (seen < left && !is_ear(at)) {
                at = next[at];
                seen++;
                continue;
            }
            emit(at, out);
            next[previous[at]] = next[at];
            previous[next[at]] = previous[at];
            at = next[next[at]]; // skipping one spreads the ears
            left--;
            seen = seen < left ? 0 : left;
            forget_convex();
        }
        emit(at, out);
    }

  private:
    std::vector<point2> points;
    std::vector<uint32_t> next, previous;
    std::vector<uint32_t> reflex; // reflex corners: only they can lie in an ear
    uint32_t clipped = 0;

    double turn(uint32_t i) const
    {
        return cross(points[previous[i]], points[i], points[next[i]]);
    }

    void emit(uint32_t i, std::vector<uint32_t> &out) const
    {
        out.insert(out.end(), {previous[i], i, next[i]});
    }

    bool is_ear(uint32_t i) const
    {
        if (turn(i) <= 0) {
            return false;
        }
        const point2 &a = points[previous[i]], &b = points[i], &c = points[next[i]];
        for (uint32_t other : reflex) {
            if (other == i || other == previous[i] || other == next[i]) {
                continue;
            }
            const point2 &p = points[other];
            if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) {
                return false;
            }
        }
        return true;
    }

    // Clipping makes corners convex: removes these from the list now and then.
    void forget_convex()
    {
        if (++clipped % 16 != 0) {
            return;
        }
        size_t kept = 0;
        for (uint32_t corner : reflex) {
            bool is_linked = next[previous[corner]] == corner && previous[next[corner]] == corner;
            if (is_linked && turn(corner) < 0) {
                reflex[kept++] = corner;
            }
        }
        reflex.resize(kept);
    }
};

void obj_triangulate(const std::vector<const float *> &corners, std::vector<uint32_t> &out)
{
    if (corners.size() == 3) {
        out.insert(out.end(), {0, 1, 2});
    } else if (corners.size() > 3) {
        ear_clipper(corners).run(out);
    }
}
