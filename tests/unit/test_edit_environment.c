// Proves that loading an environment is an edit: undo and redo bring images back, undo steps keep
// images alive exactly as long as needed, and no more of them than the limit allows. Edits an empty
// scene; reference counts show who holds an image.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/document/edit.h"

struct fixture {
    struct scene *scene;
    struct render_settings settings;
    struct document document;
    struct edit_history history;
};

static int setup(void **state)
{
    struct fixture *fixture = calloc(1, sizeof(*fixture));
    assert_non_null(fixture);
    fixture->scene = scene_create("empty");
    assert_non_null(fixture->scene);
    fixture->document = (struct document){.scene = fixture->scene, .settings = &fixture->settings};
    *state = fixture;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *fixture = *state;
    edit_history_clear(&fixture->history);
    scene_destroy(&fixture->scene);
    free(fixture);
    return 0;
}

static struct environment_image *make_image(const char *name)
{
    struct environment_image *image = environment_image_create(2, 1, calloc(6, sizeof(float)));
    assert_non_null(image);
    strcpy(image->name, name);
    return image;
}

// Loads it, and releases the test's own reference.
static void load(struct fixture *fixture, struct environment_image *image)
{
    cJSON *edit = edit_load_environment(&fixture->document, &fixture->history, image);
    assert_string_equal(cJSON_GetObjectItem(edit, "name")->valuestring, image->name);
    cJSON_Delete(edit);
    environment_image_release(&image);
}

static void replay(struct fixture *fixture, enum method method)
{
    struct command *command = calloc(1, sizeof(*command));
    cJSON *result = cJSON_CreateObject(), *edit = NULL;
    struct rpc_error error;
    command->method = method;
    assert_true(edit_apply(&fixture->document, &fixture->history, command, result, &edit, &error));
    cJSON_Delete(edit);
    cJSON_Delete(result);
    free(command);
}

static void undo_and_redo_bring_images_back(void **state)
{
    struct fixture *fixture = *state;
    const struct scene_environment *environment = &fixture->scene->environment;
    struct environment_image *a = make_image("a"), *b = make_image("b");
    environment_image_retain(a);
    uint64_t revision = fixture->scene->revisions.environment;
    load(fixture, a);
    load(fixture, b);
    assert_ptr_equal(environment->image, b);
    assert_int_equal(environment->type, SCENE_ENVIRONMENT_EQUIRECT);
    replay(fixture, METHOD_EDIT_UNDO);
    assert_ptr_equal(environment->image, a);
    replay(fixture, METHOD_EDIT_UNDO);
    assert_null(environment->image);
    assert_int_equal(environment->type, SCENE_ENVIRONMENT_NONE);
    replay(fixture, METHOD_EDIT_REDO);
    assert_ptr_equal(environment->image, a);
    assert_int_equal(fixture->scene->revisions.environment, revision + 5);
    // A new edit drops the steps that could be redone.
    load(fixture, make_image("c"));
    assert_string_equal(environment->image->name, "c");
    edit_history_clear(&fixture->history);
    assert_int_equal(a->references, 1);
    assert_int_equal(environment->image->references, 1);
    environment_image_release(&a);
}

static void steps_keep_no_more_than_the_limit(void **state)
{
    struct fixture *fixture = *state;
    for (int i = 0; i < 4; i++) {
        struct environment_image *image = make_image("large");
        image->width = 8192; // 192 MiB, as far as the history can know
        image->height = 2048;
        load(fixture, image);
    }
    // The steps keep nothing and three images, of which two fit.
    assert_int_equal(fixture->history.count, 2);
    assert_int_equal(fixture->history.position, 2);
    for (int i = 0; i < 2; i++) {
        struct environment_image *image = make_image("huge");
        image->width = 16384; // more than the limit: one step is kept nevertheless
        image->height = 4096;
        load(fixture, image);
    }
    assert_int_equal(fixture->history.count, 1);
    replay(fixture, METHOD_EDIT_UNDO);
    assert_string_equal(fixture->scene->environment.image->name, "huge");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(undo_and_redo_bring_images_back, setup, teardown),
        cmocka_unit_test_setup_teardown(steps_keep_no_more_than_the_limit, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
