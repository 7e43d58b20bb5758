/* SPDX-License-Identifier: MIT */
/* program.c: shaders read, their includes put in, compiled and linked once; a compiler's words told as one line. */
#include "gl/internal.h"
#include "gl/shader_source.h"

#include <unistd.h>

enum { MAX_FILES = 32, MAX_NAME = 64, MAX_SHADER = 1 << 20 };

/* Starts a comment line that says which line of which file the next one is: "//@ sphere.glsl:12". Drivers count the
 * lines of the whole text right, but Mesa forgets the source string number of #line in most of its errors. */
#define PLACE "//@ "

struct ssfr_gl_program {
    ssfr_gl_program *next;
    char *key; /* "vert\nfrag\ndefines" */
    unsigned name;
};

/* ---- source text ------------------------------------------------------------------------------------------------- */

/* The text of a stage, and the files that are in it. */
typedef struct sources {
    FILE *out;
    const char *defines;
    bool versioned; /* the #version line is written */
    int n;
    char names[MAX_FILES][MAX_NAME];
} sources;

static bool already_in(const sources *files, const char *name)
{
    bool found = false;
    for (int i = 0; i < files->n; i++) found = found || strcmp(files->names[i], name) == 0;
    return found;
}

/* Reads from the folder that SSFR_SHADER_DIR names where it has the file, else from the binary. `place` is who asks,
 * "" for the program itself. */
static ssfr_result load(char **out, const char *name, const char *place)
{
    const char *folder = getenv("SSFR_SHADER_DIR");
    const ssfr_shader_source *source = ssfr_shader_sources;
    char path[4096];
    size_t size;
    *out = NULL;
    if (folder && folder[0]) {
        if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path)
            return ssfr_fail(SSFR_ERR_VALUE, "SSFR_SHADER_DIR=%.80s...: too long", folder);
        if (access(path, F_OK) == 0) return ssfr_read_file(path, MAX_SHADER, out, &size);
    }
    while (source->name && strcmp(source->name, name) != 0) source++;
    if (!source->name) return ssfr_fail(SSFR_ERR_UNKNOWN, "%s%s: no such shader", place, name);
    return ssfr_text_print(out, name, "%s", source->text);
}

/* True when the line is the preprocessor's `word`; what follows it is at *rest. */
static bool is_directive(const char *line, const char *word, const char **rest)
{
    const char *at = line + strspn(line, " \t");
    if (*at != '#') return false;
    at += 1 + strspn(at + 1, " \t");
    if (strncmp(at, word, strlen(word)) != 0) return false;
    *rest = at + strlen(word);
    return strchr(" \t\"<\r\n", **rest) != NULL; /* the end of the text too */
}

static ssfr_result expand(sources *files, const char *name, const char *place);

/* `rest` is what stands behind #include in line `number` of file `index`. */
static ssfr_result include(sources *files, const char *rest, int index, int number)
{
    ssfr_result result = SSFR_OK;
    char name[MAX_NAME], place[2 * MAX_NAME];
    const int before = files->n;
    rest += strspn(rest, " \t");
    const size_t length = *rest == '"' ? strcspn(rest + 1, "\"\n") : 0;
    snprintf(place, sizeof place, "%s:%d: ", files->names[index], number);
    if (length == 0 || length >= sizeof name || rest[1 + length] != '"')
        return ssfr_fail(SSFR_ERR_FORMAT, "%sexpected #include \"name\" with a name under %d letters", place, MAX_NAME);
    memcpy(name, rest + 1, length);
    name[length] = '\0';
    if (!already_in(files, name)) SSFR_TRY(expand(files, name, place));
    if (files->n > before)
        fprintf(files->out, PLACE "%s:%d\n", files->names[index], number + 1);
    else
        fprintf(files->out, "\n"); /* once is enough */
end:
    return result;
}

/* Writes a line, or what it includes; the defines go behind the #version line. */
static ssfr_result put_line(sources *files, const char *line, int index, int number)
{
    const char *rest, *name = files->names[index];
    if (is_directive(line, "include", &rest)) return include(files, rest, index, number);
    fprintf(files->out, "%.*s\n", (int)strcspn(line, "\n"), line);
    if (files->versioned || !is_directive(line, "version", &rest)) return SSFR_OK;
    fprintf(files->out, PLACE "%s, defines:1\n%s\n", name, files->defines);
    fprintf(files->out, PLACE "%s:%d\n", name, number + 1);
    files->versioned = true;
    return SSFR_OK;
}

/* Writes a file with its includes. */
static ssfr_result expand(sources *files, const char *name, const char *place)
{
    ssfr_result result = SSFR_OK;
    const int index = files->n;
    char *text = NULL;
    SSFR_TRY(load(&text, name, place));
    if (index == MAX_FILES || strlen(name) >= MAX_NAME) {
        result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s%s: more than %d files in a shader, or a name of %d letters", place,
                           name, MAX_FILES, MAX_NAME);
        goto end;
    }
    snprintf(files->names[files->n++], MAX_NAME, "%s", name);
    if (index > 0) fprintf(files->out, PLACE "%s:1\n", name);
    const char *line = text;
    for (int number = 1; *line; number++) {
        SSFR_TRY(put_line(files, line, index, number));
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    if (index == 0 && !files->versioned) result = ssfr_fail(SSFR_ERR_FORMAT, "%s: no #version line", name);
end:
    free(text);
    return result;
}

/* The text of a stage, to free(). */
static ssfr_result expand_all(char **out, sources *files, const char *name, const char *defines)
{
    ssfr_result result = SSFR_OK;
    size_t size = 0;
    *out = NULL;
    *files = (sources){.defines = defines ? defines : ""};
    files->out = open_memstream(out, &size);
    if (!files->out) return ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for its text", name);
    result = expand(files, name, "");
    if (fclose(files->out) != 0 && result == SSFR_OK)
        result = ssfr_fail(SSFR_ERR_MEMORY, "%s: no memory for its text", name);
    if (result != SSFR_OK) {
        free(*out);
        *out = NULL;
    }
    return result;
}

/* ---- a compiler's words ------------------------------------------------------------------------------------------ */

static bool says_error(const char *line, size_t length)
{
    bool found = false;
    for (size_t i = 0; i + 5 <= length && !found; i++)
        found = strncmp(line + i, "error", 5) == 0 || strncmp(line + i, "ERROR", 5) == 0;
    return found;
}

/* The first line of a log that tells of an error; else its first that is not empty. */
static const char *error_line(const char *log)
{
    const char *first = log + strspn(log, " \r\n");
    for (const char *line = first; *line;) {
        const size_t length = strcspn(line, "\r\n");
        if (says_error(line, length)) return line;
        line += length + strspn(line + length, "\r\n");
    }
    return *first ? first : "the driver does not say why";
}

/* The forms known: Mesa's "0:12(3): error: ...", NVIDIA's "0(12) : error ...", others' "ERROR: 0:12: ...". */
const char *ssfr_gl_parse_log(const char *log, long *line)
{
    const char *text = error_line(log), *at = text + strspn(text, "ERO: ");
    char *end;
    *line = 0;
    (void)strtol(at, &end, 10);
    if (end == at || (*end != ':' && *end != '(')) return text;
    at = end + 1;
    const long number = strtol(at, &end, 10);
    if (end == at) return text;
    *line = number;
    return end + strspn(end, " :()-0123456789");
}

/* The file and its line that line `line` of the whole text is. */
static int locate(const char *text, long line, char name[MAX_NAME])
{
    int number = 1;
    for (long i = 1; i < line && *text; i++) {
        if (sscanf(text, PLACE "%63[^:]:%d", name, &number) != 2) number++;
        text += strcspn(text, "\n");
        text += *text == '\n';
    }
    return number;
}

static ssfr_result fail_compile(const char *text, const char *shader, const char *log)
{
    char name[MAX_NAME];
    long line;
    const char *said = ssfr_gl_parse_log(log, &line);
    const int length = (int)strcspn(said, "\r\n");
    if (line < 1) return ssfr_fail(SSFR_ERR_GL, "%s: %.*s", shader, length, said);
    snprintf(name, sizeof name, "%s", shader);
    const int number = locate(text, line, name);
    return ssfr_fail(SSFR_ERR_GL, "%s:%d: %.*s", name, number, length, said);
}

/* ---- compiling and linking --------------------------------------------------------------------------------------- */

static ssfr_result compile(unsigned *out, GLenum stage, const char *name, const char *defines)
{
    ssfr_result result = SSFR_OK;
    sources files;
    char log[4096] = "", *text = NULL;
    GLint ok = GL_FALSE;
    SSFR_TRY(expand_all(&text, &files, name, defines));
    *out = glCreateShader(stage);
    glShaderSource(*out, 1, (const GLchar *const *)&text, NULL);
    glCompileShader(*out);
    glGetShaderiv(*out, GL_COMPILE_STATUS, &ok);
    glGetShaderInfoLog(*out, sizeof log, NULL, log);
    if (!ok) result = fail_compile(text, name, log);
end:
    free(text);
    return result;
}

static ssfr_result build(unsigned *out, const char *vert, const char *frag, const char *defines)
{
    ssfr_result result = SSFR_OK;
    unsigned stages[2] = {0}, program = 0;
    char log[4096] = "";
    GLint ok = GL_FALSE;
    SSFR_TRY(compile(&stages[0], GL_VERTEX_SHADER, vert, defines));
    SSFR_TRY(compile(&stages[1], GL_FRAGMENT_SHADER, frag, defines));
    program = glCreateProgram();
    for (int i = 0; i < 2; i++) glAttachShader(program, stages[i]);
    glLinkProgram(program);
    for (int i = 0; i < 2; i++) glDetachShader(program, stages[i]);
    glGetProgramiv(program, GL_LINK_STATUS, &ok);
    glGetProgramInfoLog(program, sizeof log, NULL, log);
    if (!ok) {
        const char *line = error_line(log);
        result = ssfr_fail(SSFR_ERR_GL, "%s with %s: %.*s", vert, frag, (int)strcspn(line, "\r\n"), line);
        goto end;
    }
    glObjectLabel(GL_PROGRAM, program, -1, frag);
    *out = program;
    program = 0;
end:
    for (int i = 0; i < 2; i++) glDeleteShader(stages[i]);
    glDeleteProgram(program);
    return result;
}

/* ---- the cache --------------------------------------------------------------------------------------------------- */

static void entry_destroy(ssfr_gl_program *entry, bool current)
{
    if (!entry) return;
    if (current) glDeleteProgram(entry->name);
    free(entry->key);
    free(entry);
}

static ssfr_result entry_create(ssfr_gl_program **out, const char *vert, const char *frag, const char *defines)
{
    ssfr_result result = SSFR_OK;
    ssfr_gl_program *entry = NULL;
    SSFR_TRY(ssfr_alloc(&entry, 1, sizeof *entry, "a program"));
    SSFR_TRY(ssfr_text_print(&entry->key, "a program's key", "%s\n%s\n%s", vert, frag, defines));
    SSFR_TRY(build(&entry->name, vert, frag, defines));
    *out = entry;
    entry = NULL;
end:
    entry_destroy(entry, true);
    return result;
}

static bool entry_is(const ssfr_gl_program *entry, const char *vert, const char *frag, const char *defines)
{
    const size_t n_vert = strlen(vert), n_frag = strlen(frag);
    const char *key = entry->key;
    return strncmp(key, vert, n_vert) == 0 && key[n_vert] == '\n' && strncmp(key + n_vert + 1, frag, n_frag) == 0 &&
           key[n_vert + 1 + n_frag] == '\n' && strcmp(key + n_vert + n_frag + 2, defines) == 0;
}

ssfr_result ssfr_program_get(ssfr_gl *gl, unsigned *out, const char *vert, const char *frag, const char *defines)
{
    const char *given = defines ? defines : "";
    ssfr_gl_program *entry = gl->programs;
    *out = 0;
    while (entry && !entry_is(entry, vert, frag, given)) entry = entry->next;
    if (!entry) {
        const ssfr_result result = entry_create(&entry, vert, frag, given);
        if (result != SSFR_OK) return result;
        entry->next = gl->programs;
        gl->programs = entry;
        gl->allocations++;
    }
    *out = entry->name;
    return SSFR_OK;
}

void ssfr_gl_programs_finish(ssfr_gl *gl, bool current)
{
    for (ssfr_gl_program *entry = gl->programs, *next; entry; entry = next) {
        next = entry->next;
        entry_destroy(entry, current);
    }
    gl->programs = NULL;
}
